/* A stream of random numbers. */
#pragma once
#include <stdint.h>

/* Uniform in [0, 1); the state is not 0. Source: xorshift64*, Vigna, ACM Transactions on Mathematical Software 42 (2016). */
static inline double uniform(uint64_t *state) {
    uint64_t x = *state;
    x ^= x >> 12, x ^= x << 25, x ^= x >> 27;
    *state = x;
    return (double)((x * 0x2545F4914F6CDD1DULL) >> 11) * 0x1p-53;
}
