/* Passes over the values of all sets of elements: a set's number has the bits of its elements.

   Each function takes a part of the sets, so that Python looks at the clock between two parts. */
#include "lattice.h"

void disjoint_slack(const double *values, int64_t first, int64_t last, double *slack, int64_t *sets) {
    for (int64_t all = first; all < last; all++)
        for (int64_t part = all;; part = (part - 1) & all) {
            double found = values[part] + values[all ^ part] - values[all];
            if (found < *slack) *slack = found, sets[0] = part, sets[1] = all ^ part;
            if (2 * part <= all) break; /* the other half are the same pairs, swapped */
        }
}

/* Positions of all parts of a choice, by mask over the axes where it takes part, the last axis first; how many axes. */
static int fill_positions(int axes, const int64_t *sizes, int64_t choice, int64_t *positions) {
    int count = 0;
    int64_t stride = 1;
    positions[0] = 0;
    for (int a = axes - 1; a >= 0; a--) {
        int64_t option = choice % sizes[a], half = (int64_t)1 << count;
        choice /= sizes[a];
        if (option > 0) {
            for (int64_t s = 0; s < half; s++) positions[s + half] = positions[s] + option * stride;
            count++;
        }
        stride *= sizes[a];
    }
    return count;
}

void gain_ratio(const double *values, int axes, const int64_t *sizes, int64_t first, int64_t last, double noise, int64_t *positions,
                double *ratios, int64_t *sets) {
    for (int64_t top = first; top < last; top++) {
        int count = fill_positions(axes, sizes, top, positions);
        for (int64_t part = 0; part < ((int64_t)1 << count) - 1; part++) {
            double base = values[positions[part]], gain = values[top] - base, total = 0.0;
            int added = 0;
            if (!(gain > 0.0)) continue;
            for (int i = 0; i < count; i++)
                if (!(part >> i & 1)) total += values[positions[part | (int64_t)1 << i]] - base, added++;
            double sure = gain - noise, most = total + added * noise, large = gain + noise, least = total - added * noise;
            if (added == 1) sure = most = large = least = gain;
            if (sure > 0.0 && most < ratios[0] * sure) ratios[0] = most / sure, sets[0] = top, sets[1] = part;
            if (least < ratios[1] * large) ratios[1] = least / large;
        }
    }
}
