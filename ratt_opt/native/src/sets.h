/* Sets of robots as bit masks, and how a function is exported. */
#pragma once
#include <stdint.h>

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

/* Bits are added side by side, in pairs, fours and bytes: a processor of any age has no instruction for it, and the
   compiler's function for these is not inlined. */
static inline int size_of(uint64_t set) {
    set -= set >> 1 & 0x5555555555555555ULL;
    set = (set & 0x3333333333333333ULL) + (set >> 2 & 0x3333333333333333ULL);
    return (int)(((set + (set >> 4)) & 0x0F0F0F0F0F0F0F0FULL) * 0x0101010101010101ULL >> 56);
}

/* The lowest robot of a set that is not empty. */
static inline int lowest(uint64_t set) { return __builtin_ctzll(set); }
