/* Passes over the values of all sets of elements: a set's number has the bits of its elements.

   Each function takes a part of the sets, so that Python looks at the clock between two parts. */
#include <math.h>

#include "lattice.h"

enum { LANES = 32 };      /* ends side by side: one alone would wait for the one before, and is no vector instruction */
enum { BLOCK = 1 << 13 }; /* differences at once: 64 KiB, which stay in a core's own cache for all elements */
enum { FEW = 1 << 10 };   /* the same if only one element looks at them */

static inline double lesser(double a, double b) { return a < b ? a : b; }

static inline double greater(double a, double b) { return a > b ? a : b; }

/* The number of the k-th set without an element. */
static inline int64_t without(int64_t k, int element) {
    int64_t low = k & (((int64_t)1 << element) - 1);
    return (k ^ low) << 1 | low;
}

/* Lower *low and raise *high to sets[s + step] - sets[s] over s below `count` without the bit `step`, which is less than
   LANES. Places with that bit take differences that mean nothing, and are left out. */
static void spread_of_close(const double *sets, int64_t count, int64_t step, double *low, double *high) {
    double least[LANES], most[LANES];
    int64_t s = 0;
    for (int k = 0; k < LANES; k++) least[k] = INFINITY, most[k] = -INFINITY;
    for (; s + LANES + step <= count; s += LANES)
        for (int k = 0; k < LANES; k++) {
            double difference = sets[s + step + k] - sets[s + k];
            least[k] = lesser(difference, least[k]), most[k] = greater(difference, most[k]);
        }
    for (; s < count; s++) {
        double difference = s & step ? NAN : sets[s + step] - sets[s];
        *low = lesser(difference, *low), *high = greater(difference, *high);
    }
    for (int k = 0; k < LANES; k++)
        if (!(k & step)) *low = lesser(least[k], *low), *high = greater(most[k], *high);
}

/* The same of `count` sets and those that are `step` after them; `count` is a multiple of LANES. */
static void spread_of_far(const double *sets, int64_t count, int64_t step, double *low, double *high) {
    double least[LANES], most[LANES];
    for (int k = 0; k < LANES; k++) least[k] = INFINITY, most[k] = -INFINITY;
    for (int64_t s = 0; s < count; s += LANES)
        for (int k = 0; k < LANES; k++) {
            double difference = sets[s + step + k] - sets[s + k];
            least[k] = lesser(difference, least[k]), most[k] = greater(difference, most[k]);
        }
    for (int k = 0; k < LANES; k++) *low = lesser(least[k], *low), *high = greater(most[k], *high);
}

void marginal_ends(const double *values, int i, int64_t first, int64_t last, double *low, double *high) {
    int64_t step = (int64_t)1 << i;
    if (step < LANES) {
        spread_of_close(values + 2 * first, 2 * (last - first), step, low, high);
        return;
    }
    while (first < last) {
        int64_t run = step - (first & (step - 1));
        if (run > last - first) run = last - first;
        spread_of_far(values + without(first, i), run, step, low, high);
        first += run;
    }
}

/* The smallest of above[s] - below[s]; `count` is a multiple of LANES. */
static double smallest_difference(const double *above, const double *below, int64_t count, double known) {
    double least[LANES];
    for (int k = 0; k < LANES; k++) least[k] = known;
    for (int64_t s = 0; s < count; s += LANES)
        for (int k = 0; k < LANES; k++) least[k] = lesser(above[s + k] - below[s + k], least[k]);
    for (int k = 0; k < LANES; k++) known = lesser(least[k], known);
    return known;
}

/* falls (size) = f(S) - f(S + j) of the sets without j from number `first` on. */
static void fill_falls(const double *values, int j, int64_t first, int64_t size, double *falls) {
    int64_t step = (int64_t)1 << j;
    for (int64_t done = 0; done < size;) {
        int64_t k = first + done, run = step - (k & (step - 1));
        if (run > size - done) run = size - done;
        const double *without_j = values + without(k, j), *with_j = without_j + step;
        for (int64_t s = 0; s < run; s++) falls[done + s] = without_j[s] - with_j[s];
        done += run;
    }
}

/* The smallest falls[s + step] - falls[s] over s below `size` without the bit `step`. */
static double smallest_rise(const double *falls, int64_t size, int64_t step) {
    double low = INFINITY;
    if (step >= LANES) {
        for (int64_t base = 0; base < size; base += 2 * step) low = smallest_difference(falls + base + step, falls + base, step, low);
    } else if (size >= LANES) {
        /* All places side by side, and LANES more at the end; those with the bit mean nothing, and are left out. */
        double least[LANES];
        for (int k = 0; k < LANES; k++) least[k] = INFINITY;
        for (int64_t s = 0; s < size; s += LANES)
            for (int k = 0; k < LANES; k++) least[k] = lesser(falls[s + step + k] - falls[s + k], least[k]);
        for (int k = 0; k < LANES; k++)
            if (!(k & step)) low = lesser(least[k], low);
    } else {
        for (int64_t s = 0; s < size; s++)
            if (!(s & step)) low = lesser(falls[s + step] - falls[s], low);
    }
    return low;
}

void near_differences(const double *values, int j, int64_t first, int64_t last, double *ends) {
    double falls[BLOCK + LANES] = {0};
    for (; first < last; first += BLOCK) {
        int64_t size = last - first < BLOCK ? last - first : BLOCK;
        fill_falls(values, j, first, size, falls);
        for (int i = 0; i < j && (int64_t)1 << i < size; i++) ends[i] = lesser(smallest_rise(falls, size, (int64_t)1 << i), ends[i]);
    }
}

double far_differences(const double *values, int i, int j, int64_t first, int64_t last, double known) {
    double low[FEW], high[FEW];
    for (; first < last; first += FEW) {
        const double *neither = values + without(without(first, i), j), *lower = neither + ((int64_t)1 << i);
        for (int64_t s = 0; s < FEW; s++)
            low[s] = neither[s] - neither[s + ((int64_t)1 << j)], high[s] = lower[s] - lower[s + ((int64_t)1 << j)];
        known = smallest_difference(high, low, FEW, known);
    }
    return known;
}

void disjoint_slack(const double *values, int64_t first, int64_t last, double *slack, int64_t *sets) {
    for (int64_t all = first; all < last; all++)
        for (int64_t part = all;; part = (part - 1) & all) {
            double found = values[part] + values[all ^ part] - values[all];
            if (found < *slack) *slack = found, sets[0] = part, sets[1] = all ^ part;
            if (2 * part <= all) break; /* the other half are the same pairs, swapped */
        }
}

void overlapping_slack(const double *values, int64_t count, int64_t first, int64_t last, double *slack, int64_t *sets) {
    for (int64_t a = first; a < last; a++)
        for (int64_t b = a; b < count; b++) {
            double found = values[a] + values[b] - values[a | b];
            if (found < *slack) *slack = found, sets[0] = a, sets[1] = b;
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
