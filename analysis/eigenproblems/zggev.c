/* Problems per second of LAPACK's zggev, eigenvalues only, on the file that eigenproblems.rs
 * writes. `zggev FILE`: for each line SET on standard input prints the rate of that set. Each call
 * copies its two matrices first, as zggev overwrites them. */
#include <complex.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef double complex number;

void zggev_(const char *, const char *, const int *, number *, const int *, number *, const int *,
            number *, number *, number *, const int *, number *, const int *, number *, const int *,
            double *, int *, size_t, size_t);

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

int main(int argc, char **argv) {
    FILE *file = argc > 1 ? fopen(argv[1], "rb") : NULL;
    uint64_t sets, head[16][2];
    number *data[16];
    if (!file || fread(&sets, 8, 1, file) != 1 || sets > 16) return 1;
    for (uint64_t s = 0; s < sets; s++) {
        if (fread(head[s], 8, 2, file) != 2) return 1;
        size_t numbers = 2 * head[s][0] * head[s][0] * head[s][1];
        data[s] = malloc(numbers * sizeof(number));
        if (!data[s] || fread(data[s], sizeof(number), numbers, file) != numbers) return 1;
    }
    puts("ready");
    fflush(stdout);
    for (int set; scanf("%d", &set) == 1 && set >= 0 && (uint64_t)set < sets;) {
        const int n = head[set][0], one = 1, room = 33 * n;
        const size_t square = (size_t)n * n;
        number left[100], right[100], alpha[10], beta[10], none[1], work[330];
        double real[80], start = now(), elapsed;
        long solved = 0;
        do {
            for (uint64_t p = 0; p < head[set][1]; p++, solved++) {
                int info;
                memcpy(left, data[set] + 2 * p * square, square * sizeof(number));
                memcpy(right, data[set] + (2 * p + 1) * square, square * sizeof(number));
                zggev_("N", "N", &n, left, &n, right, &n, alpha, beta, none, &one, none, &one, work,
                       &room, real, &info, 1, 1);
                if (info) fprintf(stderr, "problem %lu: info %d\n", (unsigned long)p, info);
            }
            elapsed = now() - start;
        } while (elapsed < 0.5);
        printf("%g\n", solved / elapsed);
        fflush(stdout);
    }
    return 0;
}
