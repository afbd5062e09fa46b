/* Contexts of one element, planar targets by mean, even and odd parts: descent to an extreme marginal, and ceilings. */
#include <math.h>
#include <string.h>

#include "planar.h"

enum { LANES = 8 }; /* targets side by side */

static inline double lesser(double a, double b) { return a < b ? a : b; }

static inline double level(double mean, double even, double odd) { return mean - sqrt(even * even + odd * odd); }

/* Times the sign: the marginal 1/P - 1/Q, P and Q the smallest levels of rest + part without and with what is added. */
static double marginal(const Descent *d, const double *rest, const double *part) {
    int64_t targets = d->targets, j = 0;
    const double *mean = rest, *even = mean + targets, *odd = even + targets;
    const double *means = part, *evens = means + targets, *odds = evens + targets;
    const double *more = d->added, *more_even = more + targets, *more_odd = more_even + targets;
    double before[LANES], after[LANES];
    for (int k = 0; k < LANES; k++) before[k] = after[k] = INFINITY;
    for (; j + LANES <= targets; j += LANES) {
        double low[LANES], high[LANES];
        for (int k = 0; k < LANES; k++) {
            double x = mean[j + k] + means[j + k], y = even[j + k] + evens[j + k], z = odd[j + k] + odds[j + k];
            low[k] = level(x, y, z), high[k] = level(x + more[j + k], y + more_even[j + k], z + more_odd[j + k]);
        }
        for (int k = 0; k < LANES; k++) before[k] = lesser(low[k], before[k]), after[k] = lesser(high[k], after[k]);
    }
    for (; j < targets; j++) {
        double x = mean[j] + means[j], y = even[j] + evens[j], z = odd[j] + odds[j];
        before[0] = lesser(level(x, y, z), before[0]);
        after[0] = lesser(level(x + more[j], y + more_even[j], z + more_odd[j]), after[0]);
    }
    for (int k = 1; k < LANES; k++) before[0] = lesser(before[k], before[0]), after[0] = lesser(after[k], after[0]);
    return d->sign * ((after[0] - before[0]) / (before[0] * after[0]));
}

static const double *parts_of(const Descent *d, int64_t option) { return d->parts + option * 3 * d->targets; }

/* out = total + sign * part; `out` may be `total`. */
static void add(const Descent *d, const double *total, double sign, const double *part, double *out) {
    for (int64_t t = 0; t < 3 * d->targets; t++) out[t] = total[t] + sign * part[t];
}

/* By more than rounding, by which two contexts would take turns. */
static int is_better(const Descent *d, double found) { return found < d->value - fmax(d->relative * fabs(d->value), d->rounding); }

int descend(Descent *d) {
    int improved = 0;
    for (int64_t i = 0; i < d->owners; i++) {
        int64_t now = d->picks[i];
        add(d, d->total, -1.0, parts_of(d, now), d->rest);
        for (int64_t k = d->ends[i]; k < d->ends[i + 1]; k++) {
            double found = marginal(d, d->rest, parts_of(d, k));
            if (is_better(d, found)) d->picks[i] = k, d->value = found;
        }
        if (d->picks[i] == now) continue;
        improved = 1;
        add(d, d->rest, 1.0, parts_of(d, d->picks[i]), d->total);
    }
    return improved;
}

void descend_pairs(Descent *d, int64_t i) {
    for (int64_t j = i + 1; j < d->owners; j++) {
        int64_t first = d->picks[i], second = d->picks[j];
        add(d, d->total, -1.0, parts_of(d, first), d->rest);
        add(d, d->rest, -1.0, parts_of(d, second), d->rest);
        for (int64_t k = d->ends[i]; k < d->ends[i + 1]; k++) {
            add(d, d->rest, 1.0, parts_of(d, k), d->one);
            for (int64_t m = d->ends[j]; m < d->ends[j + 1]; m++) {
                double found = marginal(d, d->one, parts_of(d, m));
                if (is_better(d, found)) d->picks[i] = k, d->picks[j] = m, d->value = found;
            }
        }
        if (d->picks[i] == first && d->picks[j] == second) continue;
        add(d, d->rest, 1.0, parts_of(d, d->picks[i]), d->one);
        add(d, d->one, 1.0, parts_of(d, d->picks[j]), d->total);
    }
}

void sum_ceilings(int64_t count, int64_t options, int64_t width, const int64_t *owners, const double *levels, const double *slopes,
                  const double *own, double *best, double *sums, double *sizes) {
    memset(sums, 0, (size_t)(count * width) * sizeof(double)), memset(sizes, 0, (size_t)(count * width) * sizeof(double));
    for (int64_t b = 0; b < count; b++, levels += options, sums += width, sizes += width)
        for (int64_t k = 0; k < options; k++) {
            const double *row = own + k * width;
            double slope = slopes[b], level = levels[k];
            int is_first = k == 0 || owners[k] != owners[k - 1], is_last = k + 1 == options || owners[k + 1] != owners[k];
            for (int64_t s = 0; s < width && is_first; s++) best[s] = -INFINITY;
            for (int64_t s = 0; s < width; s++) {
                double value = level - slope * row[s];
                best[s] = value > best[s] ? value : best[s];
            }
            for (int64_t s = 0; s < width && is_last; s++) sums[s] += best[s], sizes[s] += fabs(best[s]);
        }
}
