/* Sets of robots as bit masks, and how a function is exported. */
#ifndef RATT_SETS_H
#define RATT_SETS_H

#include <stdint.h>

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

static inline int size_of(uint64_t set) { return __builtin_popcountll(set); }

/* The lowest robot of a set that is not empty. */
static inline int lowest(uint64_t set) { return __builtin_ctzll(set); }

/* Take the lowest robot out of a set that is not empty, and return it. */
static inline int next_robot(uint32_t *set) {
    int robot = __builtin_ctz(*set);
    *set &= *set - 1;
    return robot;
}

#endif
