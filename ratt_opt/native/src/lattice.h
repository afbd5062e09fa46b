/* Passes over the values of all sets of elements. */
#pragma once
#include "sets.h"

/* Lower *slack to f(A) + f(B) - f(A + B) of disjoint A, B whose unions are first..last - 1; `sets`: those A and B. */
EXPORTED void disjoint_slack(const double *values, int64_t first, int64_t last, double *slack, int64_t *sets);
/* Lower ratios[0] to (sum of f(S + w) - f(S) over w in T - S) / (f(T) - f(S)), if that gain is positive, of T at positions
   first..last - 1 and S in T; `sets`: T and the mask of S. A difference may be off by `noise`: ratios[0] is what the ratio
   is at most, of gains above it, ratios[1] what it is at least, of all. If T has one element more than S, it is 1.
   `values`: one axis of `sizes` (axes) options each, option 0 being none; `positions` (1 << axes) is spare. */
EXPORTED void gain_ratio(const double *values, int axes, const int64_t *sizes, int64_t first, int64_t last, double noise,
                         int64_t *positions, double *ratios, int64_t *sets);
