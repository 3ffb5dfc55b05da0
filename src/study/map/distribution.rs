//! Distribution of the points of a map over ranks: chunks of points in turn, since neighbouring points take about the
//! same time.

use dynamics::decomposition::communicator::Communicator;

/// Distribution of a list over ranks, in chunks.
pub(super) struct Distribution<'a> {
    communicator: &'a dyn Communicator,
    chunk_length: usize,
}

impl<'a> Distribution<'a> {
    pub(super) fn new(communicator: &'a dyn Communicator, chunk_length: usize) -> Self {
        Self { communicator, chunk_length }
    }

    /// Returns whether this rank computes a chunk.
    pub(super) fn is_own(&self, chunk: usize) -> bool {
        chunk % self.communicator.size() == self.communicator.rank()
    }

    /// Returns the number of values that this rank computes, of a list of `count`.
    pub(super) fn own_count(&self, count: usize) -> usize {
        let chunks = (0..count.div_ceil(self.chunk_length)).filter(|chunk| self.is_own(*chunk));
        chunks.map(|chunk| self.chunk_length.min(count - chunk * self.chunk_length)).sum()
    }

    /// Replaces the values of other ranks by those that they have computed; all ranks call it with lists of the same
    /// length. `encode` and `decode` convert a value to numbers and back, all bits included.
    pub(super) fn exchange<V, const N: usize>(
        &self,
        values: &mut [V],
        encode: impl Fn(&V) -> [f64; N],
        decode: impl Fn([f64; N]) -> V,
    ) {
        let ranks = self.communicator.size();
        if ranks == 1 {
            return;
        }
        let own = values.chunks(self.chunk_length).skip(self.communicator.rank()).step_by(ranks);
        let message = own.flatten().flat_map(&encode).flat_map(f64::to_le_bytes).collect();
        for (rank, message) in self.communicator.gather_to_all(message).into_iter().enumerate() {
            let numbers = message.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes));
            let numbers: Vec<f64> = numbers.collect();
            let chunks = values.chunks_mut(self.chunk_length).skip(rank).step_by(ranks);
            for (value, own) in chunks.flatten().zip(numbers.as_chunks().0) {
                *value = decode(*own);
            }
        }
    }

    /// Returns the smallest of the numbers of all ranks that have one; all ranks call it.
    pub(super) fn find_least(&self, own: Option<usize>) -> Option<usize> {
        let message = own.map(|own| (own as u64).to_le_bytes().to_vec()).unwrap_or_default();
        let all = self.communicator.gather_to_all(message);
        let number = |message: &Vec<u8>| Some(u64::from_le_bytes(*message.first_chunk()?) as usize);
        all.iter().filter_map(number).min()
    }
}
