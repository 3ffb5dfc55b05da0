//! Library of the Message Passing Interface, loaded at run time.
//!
//! The only unsafe code of the ranks is here: function pointers, and buffers that the library reads or writes after a
//! call has returned. Handles of communicators, types and requests are integers of four bytes in MPICH and pointers in
//! the other libraries; both travel in one register, so that all are passed as integers of the size of a pointer.

use libloading::os::unix::{Library, RTLD_GLOBAL, RTLD_NOW, Symbol};
use std::ffi::{c_char, c_int, c_void};
use std::sync::{Mutex, PoisonError};

/// Handle of an MPI object.
type Handle = isize;

/// Capacity of the buffers for texts, at least `MPI_MAX_LIBRARY_VERSION_STRING` of all libraries.
const MAX_TEXT_LENGTH: usize = 8192;

/// Code with which all ranks end after a failure.
const ABORT_CODE: c_int = 2;

/// Constants that differ between the binary interfaces of MPI libraries.
#[derive(Clone, Copy, Debug)]
struct Constants {
    /// `MPI_COMM_WORLD`.
    world: Handle,
    /// `MPI_BYTE`.
    byte: Handle,
    /// `MPI_ERRORS_RETURN`.
    errors_return: Handle,
    /// `MPI_STATUS_IGNORE`.
    ignored_status: Handle,
    /// `MPI_THREAD_SERIALIZED`: any thread may call, one at a time.
    serialized: c_int,
}

/// Constants of the binary interface that MPICH and the libraries derived from it share (`mpi.h` of MPICH 3.1 to 5.0).
const MPICH: Constants = Constants {
    world: 0x4400_0000,
    byte: 0x4c00_010d,
    errors_return: 0x5400_0001,
    ignored_status: 1,
    serialized: 2,
};

/// Constants of the standard binary interface (MPI 5.0, chapter 20, `mpi_abi.h`).
const STANDARD: Constants = Constants {
    world: 0x101,
    byte: 0x247,
    errors_return: 0x143,
    ignored_status: 0,
    serialized: 2048,
};

/// Error of the search for an MPI library or of its start.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MpiError {
    /// No library could be loaded.
    #[error(
        "the program was started by an MPI launcher, but no MPI library can be loaded; tried: {}; \
         install one, or name its file in {LIBRARY_VARIABLE}", attempts.join("; ")
    )]
    NoLibrary {
        /// Each file tried, and why it was not loaded.
        attempts: Vec<String>,
    },
    /// The library lacks a function.
    #[error("{library}: no function {function}: not an MPI library, or one before MPI 3")]
    MissingFunction {
        /// File of the library.
        library: String,
        /// Function that is missing.
        function: String,
    },
    /// A function of the library failed.
    #[error("{library}: {function}: {cause}")]
    Failed {
        /// File of the library.
        library: String,
        /// Function that failed.
        function: &'static str,
        /// Description by the library.
        cause: String,
    },
    /// The launcher belongs to another library.
    #[error(
        "the launcher started {launched} processes, but {library} connects {connected}: the launcher belongs to another \
         MPI library; name the file of that one in {LIBRARY_VARIABLE}"
    )]
    OtherLauncher {
        /// File of the library.
        library: String,
        /// Number of processes according to the launcher.
        launched: usize,
        /// Number of processes according to the library.
        connected: usize,
    },
}

/// Environment variable with the file of the MPI library to be loaded.
pub(super) const LIBRARY_VARIABLE: &str = "WELLPOSED_MPI";

type InitThread =
    unsafe extern "C" fn(*mut c_int, *mut *mut *mut c_char, c_int, *mut c_int) -> c_int;
type CommNumber = unsafe extern "C" fn(Handle, *mut c_int) -> c_int;
type SetErrorHandler = unsafe extern "C" fn(Handle, Handle) -> c_int;
type ErrorString = unsafe extern "C" fn(c_int, *mut c_char, *mut c_int) -> c_int;
type LibraryVersion = unsafe extern "C" fn(*mut c_char, *mut c_int) -> c_int;
type Abort = unsafe extern "C" fn(Handle, c_int) -> c_int;
type Finalize = unsafe extern "C" fn() -> c_int;
type Isend =
    unsafe extern "C" fn(*const c_void, c_int, Handle, c_int, c_int, Handle, *mut Handle) -> c_int;
type Irecv =
    unsafe extern "C" fn(*mut c_void, c_int, Handle, c_int, c_int, Handle, *mut Handle) -> c_int;
type Test = unsafe extern "C" fn(*mut Handle, *mut c_int, Handle) -> c_int;

/// Functions of the library.
#[derive(Debug)]
struct Functions {
    init_thread: InitThread,
    comm_rank: CommNumber,
    comm_size: CommNumber,
    set_error_handler: SetErrorHandler,
    error_string: ErrorString,
    library_version: LibraryVersion,
    abort: Abort,
    finalize: Finalize,
    isend: Isend,
    irecv: Irecv,
    test: Test,
}

/// Transfer that has begun: the buffer must neither move nor be freed before it has completed.
#[derive(Debug)]
struct Transfer {
    request: Handle,
    /// Buffer of a message that is being sent; `None` if its owner waits for the end of the transfer.
    _buffer: Option<Vec<u8>>,
}

/// An MPI library that has been started. Its functions are called by one thread at a time.
#[derive(Debug)]
pub(super) struct MpiLibrary {
    functions: Functions,
    constants: Constants,
    name: String,
    /// Messages that are being sent; the lock is held during each call of the library.
    sending: Mutex<Vec<Transfer>>,
    /// Keeps the functions loaded.
    _library: Library,
}

impl MpiLibrary {
    /// Loads the first library of `names` that can be loaded.
    pub(super) fn load(names: &[String]) -> Result<Self, MpiError> {
        let mut attempts = Vec::new();
        for name in names {
            // SAFETY: MPI libraries have no preconditions on their initialisers. Their plug-ins look for symbols of the
            // library, hence the global visibility.
            match unsafe { Library::open(Some(name), RTLD_NOW | RTLD_GLOBAL) } {
                Ok(library) => return Self::from_library(library, name),
                Err(error) => {
                    // The source is the text of the loader.
                    let cause = std::error::Error::source(&error).map(ToString::to_string);
                    attempts
                        .push(format!("{name} ({})", cause.unwrap_or_else(|| error.to_string())));
                }
            }
        }
        Err(MpiError::NoLibrary { attempts })
    }

    fn from_library(library: Library, name: &str) -> Result<Self, MpiError> {
        let address = |symbol: &str| -> Option<Handle> {
            // SAFETY: the address of the symbol is taken and not read.
            let symbol: Symbol<*mut c_void> = unsafe { library.get(symbol.as_bytes()) }.ok()?;
            Some(symbol.into_raw() as Handle)
        };
        let constants = match address("ompi_mpi_comm_world") {
            Some(world) => {
                let missing = |function: &str| MpiError::MissingFunction {
                    library: name.to_owned(),
                    function: function.to_owned(),
                };
                let object = |symbol: &str| address(symbol).ok_or_else(|| missing(symbol));
                Constants {
                    world,
                    byte: object("ompi_mpi_byte")?,
                    errors_return: object("ompi_mpi_errors_return")?,
                    ignored_status: 0,
                    serialized: 2,
                }
            }
            // Libraries of MPICH have the functions of the standard interface as well: the name tells them apart.
            None if name.contains("mpi_abi") => STANDARD,
            None => MPICH,
        };
        // SAFETY: the types of the functions are those of the C interface of MPI, with handles passed as integers of
        // the size of a pointer.
        let functions = unsafe {
            Functions {
                init_thread: find(&library, name, "MPI_Init_thread")?,
                comm_rank: find(&library, name, "MPI_Comm_rank")?,
                comm_size: find(&library, name, "MPI_Comm_size")?,
                set_error_handler: find(&library, name, "MPI_Comm_set_errhandler")?,
                error_string: find(&library, name, "MPI_Error_string")?,
                library_version: find(&library, name, "MPI_Get_library_version")?,
                abort: find(&library, name, "MPI_Abort")?,
                finalize: find(&library, name, "MPI_Finalize")?,
                isend: find(&library, name, "MPI_Isend")?,
                irecv: find(&library, name, "MPI_Irecv")?,
                test: find(&library, name, "MPI_Test")?,
            }
        };
        let sending = Mutex::default();
        Ok(Self { functions, constants, name: name.to_owned(), sending, _library: library })
    }

    /// Returns the name of the file.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Starts the library and returns the rank of this process and the number of ranks.
    pub(super) fn start(&self) -> Result<[usize; 2], MpiError> {
        let (none, mut provided) = (std::ptr::null_mut(), 0);
        let Constants { world, serialized, errors_return, .. } = self.constants;
        // SAFETY: MPI allows null pointers in place of the arguments of the program; called once per process.
        let started =
            unsafe { (self.functions.init_thread)(none, none.cast(), serialized, &mut provided) };
        self.check("MPI_Init_thread", started)?;
        if provided < serialized {
            let cause = "does not allow calls by several threads".to_owned();
            let library = self.name.clone();
            return Err(MpiError::Failed { library, function: "MPI_Init_thread", cause });
        }
        let [mut rank, mut size] = [0; 2];
        // SAFETY: the library has been started; the handles are its own and the pointers are to integers.
        let codes = unsafe {
            [
                (self.functions.set_error_handler)(world, errors_return),
                (self.functions.comm_rank)(world, &mut rank),
                (self.functions.comm_size)(world, &mut size),
            ]
        };
        for (function, code) in
            ["MPI_Comm_set_errhandler", "MPI_Comm_rank", "MPI_Comm_size"].into_iter().zip(codes)
        {
            self.check(function, code)?;
        }
        Ok([rank as usize, size as usize])
    }

    /// Returns the first line of the library's description of itself.
    pub(super) fn version(&self) -> String {
        // SAFETY: the buffer has the length that the library requires.
        let text =
            read_text(|text, length| unsafe { (self.functions.library_version)(text, length) });
        text.lines().next().unwrap_or_default().to_owned()
    }

    /// Begins to send a message.
    pub(super) fn begin_send(
        &self,
        receiver: usize,
        tag: u16,
        message: Vec<u8>,
    ) -> Result<(), MpiError> {
        let mut sending = self.sending.lock().unwrap_or_else(PoisonError::into_inner);
        self.drop_sent(&mut sending)?;
        let mut request = 0;
        // SAFETY: the buffer is kept in `sending`, unchanged, until the transfer has completed; moving a `Vec` does not
        // move its elements. The lock is held.
        let begun = unsafe {
            (self.functions.isend)(
                message.as_ptr().cast(),
                message.len() as c_int,
                self.constants.byte,
                receiver as c_int,
                tag.into(),
                self.constants.world,
                &mut request,
            )
        };
        self.check("MPI_Isend", begun)?;
        sending.push(Transfer { request, _buffer: Some(message) });
        Ok(())
    }

    /// Waits for a message and writes it to `message`.
    pub(super) fn receive(
        &self,
        sender: usize,
        tag: u16,
        message: &mut [u8],
        mut pause: impl FnMut(),
    ) -> Result<(), MpiError> {
        let mut transfer = Transfer { request: 0, _buffer: None };
        {
            let _lock = self.sending.lock().unwrap_or_else(PoisonError::into_inner);
            // SAFETY: `message` is borrowed until this function returns, which is after the transfer; if the library
            // reports that the transfer failed, it does not write any more. The lock is held.
            let begun = unsafe {
                (self.functions.irecv)(
                    message.as_mut_ptr().cast(),
                    message.len() as c_int,
                    self.constants.byte,
                    sender as c_int,
                    tag.into(),
                    self.constants.world,
                    &mut transfer.request,
                )
            };
            self.check("MPI_Irecv", begun)?;
        }
        loop {
            {
                let _lock = self.sending.lock().unwrap_or_else(PoisonError::into_inner);
                if self.is_complete(&mut transfer)? {
                    return Ok(());
                }
            }
            pause();
        }
    }

    /// Waits until all messages have been sent, and stops the library.
    pub(super) fn finish(&self, mut pause: impl FnMut()) -> Result<(), MpiError> {
        loop {
            let mut sending = self.sending.lock().unwrap_or_else(PoisonError::into_inner);
            self.drop_sent(&mut sending)?;
            if sending.is_empty() {
                // SAFETY: no transfer is left, and the lock is held.
                return self.check("MPI_Finalize", unsafe { (self.functions.finalize)() });
            }
            drop(sending);
            pause();
        }
    }

    /// Ends all ranks.
    pub(super) fn abort(&self) -> ! {
        // SAFETY: MPI allows this call at any time after the start; it does not wait for other calls.
        unsafe { (self.functions.abort)(self.constants.world, ABORT_CODE) };
        std::process::exit(ABORT_CODE)
    }

    /// Frees the buffers of messages that have been sent.
    fn drop_sent(&self, sending: &mut Vec<Transfer>) -> Result<(), MpiError> {
        let mut index = 0;
        while let Some(transfer) = sending.get_mut(index) {
            match self.is_complete(transfer)? {
                true => drop(sending.swap_remove(index)),
                false => index += 1,
            }
        }
        Ok(())
    }

    /// Returns whether a transfer has completed; called with the lock held.
    fn is_complete(&self, transfer: &mut Transfer) -> Result<bool, MpiError> {
        let mut is_complete = 0;
        let ignored = self.constants.ignored_status;
        // SAFETY: the request is that of a transfer that has begun and not been freed; after its end it is null, which
        // tests as complete.
        let tested =
            unsafe { (self.functions.test)(&mut transfer.request, &mut is_complete, ignored) };
        self.check("MPI_Test", tested)?;
        Ok(is_complete != 0)
    }

    /// Converts the code of a function of the library to an error.
    fn check(&self, function: &'static str, code: c_int) -> Result<(), MpiError> {
        if code == 0 {
            return Ok(());
        }
        // SAFETY: the buffer has the length that the library requires.
        let cause =
            read_text(|text, length| unsafe { (self.functions.error_string)(code, text, length) });
        Err(MpiError::Failed { library: self.name.clone(), function, cause })
    }
}

/// Finds a function of the library.
///
/// # Safety
/// `F` must be the type of the function.
unsafe fn find<F: Copy>(library: &Library, name: &str, function: &str) -> Result<F, MpiError> {
    // SAFETY: the caller guarantees the type; the function is not called after `library` has been dropped, since
    // `MpiLibrary` owns both.
    let found: Result<Symbol<F>, _> = unsafe { library.get(function.as_bytes()) };
    found.map(|symbol| *symbol).map_err(|_| MpiError::MissingFunction {
        library: name.to_owned(),
        function: function.to_owned(),
    })
}

/// Returns the text that a function of the library writes to a buffer, with its length.
fn read_text(write: impl FnOnce(*mut c_char, *mut c_int) -> c_int) -> String {
    let (mut text, mut length) = (vec![0_u8; MAX_TEXT_LENGTH], 0);
    write(text.as_mut_ptr().cast(), &mut length);
    text.truncate(length.clamp(0, MAX_TEXT_LENGTH as c_int) as usize);
    String::from_utf8_lossy(&text).trim_end_matches('\0').to_owned()
}
