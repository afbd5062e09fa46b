/* Marginal gains of the greedy algorithm's candidates, planar targets; why the bounds hold is in lazy_greedy.py. */
#include <math.h>

#include "planar.h"

enum { LANES = 8 }; /* targets side by side; the ratios of so many determinants have a product, see team.c, PRODUCTS */

typedef struct {
    double gain, bound;
} Gain;

/* The sum of what lanes add, in an order of its own, which is the same on every processor. */
static double sum_of(const double *lanes) {
    double total = 0.0;
    for (int k = 0; k < LANES; k++) total += lanes[k];
    return total;
}

/* How much a trace falls. */
static Gain trace_gain(const Greedy *g, const double *added) {
    const double *x = g->sums, *y = x + g->width, *z = y + g->width, *u = added, *v = u + g->width, *t = v + g->width;
    const double *p = g->covariances, *q = p + g->width, *r = q + g->width, *largest = r + g->width;
    double gains[LANES] = {0}, bounds[LANES] = {0}, gain[LANES], later[LANES];
    for (int64_t j = 0; j < g->width; j += LANES) {
        const double *weights = g->weights + j;
        for (int k = 0; k < LANES; k++) {
            int64_t n = j + k;
            double a = x[n] + u[n], b = y[n] + v[n], c = z[n] + t[n], determinant = a * c - b * b;
            double mu = p[n] * u[n] + 2.0 * q[n] * v[n] + r[n] * t[n], share = 1.0 / (determinant * (1.0 + mu)); /* once for both */
            gain[k] = p[n] + r[n] - (a + c) * (1.0 + mu) * share, later[k] = largest[n] * mu * determinant * share;
        }
        for (int k = 0; k < LANES; k++) later[k] = gain[k] > later[k] ? gain[k] : later[k];
        for (int k = 0; k < LANES; k++) gains[k] += weights[k] * gain[k], bounds[k] += weights[k] * later[k];
    }
    return (Gain){sum_of(gains), sum_of(bounds)};
}

/* How much log-determinants rise. */
static Gain logdet_gain(const Greedy *g, const double *added) {
    const double *x = g->sums, *y = x + g->width, *z = y + g->width, *u = added, *v = u + g->width, *t = v + g->width;
    const double *p = g->covariances, *q = p + g->width, *r = q + g->width;
    double total = 0.0, ratios[LANES];
    for (int64_t j = 0; j < g->width; j += LANES) {
        const double *weights = g->weights + j;
        int alike = 1;
        for (int k = 0; k < LANES; k++) {
            int64_t n = j + k;
            double a = x[n] + u[n], b = y[n] + v[n], c = z[n] + t[n];
            ratios[k] = (a * c - b * b) * (p[n] * r[n] - q[n] * q[n]);
            alike &= weights[k] == weights[0];
        }
        double product = 1.0;
        for (int k = 0; k < LANES; k++) {
            product *= ratios[k];
            if (alike && k < LANES - 1) continue;
            total += weights[k] * log(product);
            product = 1.0;
        }
    }
    return (Gain){total, total};
}

/* How much the largest weighted eigenvalue falls; -infinity once that is less than `enough`. Nothing bounds later gains. */
static Gain largest_gain(const Greedy *g, const double *added, double enough) {
    const double *largest = g->covariances + 3 * g->width;
    double now = -INFINITY, after = -INFINITY;
    for (int64_t n = 0; n < g->targets; n++) {
        int64_t j = g->order[n];
        double before = g->weights[j] * largest[j];
        if (n == 0) now = before;
        if (before <= after) break; /* so are all that follow */
        double a = g->sums[j] + added[j], b = g->sums[g->width + j] + added[g->width + j];
        double c = g->sums[2 * g->width + j] + added[2 * g->width + j], half = (a - c) / 2;
        after = fmax(after, g->weights[j] * ((a + c) / 2 + sqrt(half * half + b * b)) / (a * c - b * b));
        if (now - after < enough) return (Gain){-INFINITY, INFINITY};
    }
    return (Gain){now - after, INFINITY};
}

double evaluate_gains(const Greedy *g, const int64_t *candidates, int64_t count, double close, double best) {
    for (int64_t n = 0; n < count; n++) {
        int64_t e = candidates[n];
        if (g->bounds[e] < best - close) continue;
        const double *added = g->information + e * 3 * g->width;
        Gain found = g->criterion == TRACE     ? trace_gain(g, added)
                     : g->criterion == LOG_DET ? logdet_gain(g, added)
                                               : largest_gain(g, added, best - close);
        g->gains[e] = found.gain, g->bounds[e] = found.bound;
        best = fmax(best, found.gain);
    }
    return best;
}
