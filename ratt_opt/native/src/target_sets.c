/* The set of elements that is worth most beyond prices, by a search in depth.

   What elements add to a set is at most the sum of their marginals beyond it, over robots the largest beyond its price:
   of a log-determinant the marginal at the set itself, of a trace that or the one at a point of lower rank (trace.py). */
#include "target_sets.h"

#include <math.h>
#include <string.h>

enum { MOST_ENTRIES = LARGEST_DIMENSION * (LARGEST_DIMENSION + 1) / 2 };
static const double MARGIN = 1e-11; /* of rounding in a marginal, as in trace.py */

typedef struct {
    const Seers *seers;
    const double *prices;
    double best, tolerance;
    int64_t nodes;
    int64_t chosen[64], found[64];
} Search;

static double criterion_at(const Seers *s, const double *matrix) {
    return s->weight * (s->criterion == TRACE ? trace_of_inverse(s->dimension, matrix) : -log_determinant(s->dimension, matrix));
}

static int entries_at(const Seers *s) { return s->dimension * (s->dimension + 1) / 2; }

/* What a point of lower rank may add in the plane: the covariance's largest eigenvalue times q / (1 + q), where q is the
   larger eigenvalue of covariance times information. */
static double lower_rank(const double *base, const double *own) {
    double det = base[0] * base[2] - base[1] * base[1], p = base[2] / det, m = -base[1] / det, r = base[0] / det;
    double largest = (p + r) / 2 + sqrt((p - r) * (p - r) / 4 + m * m);
    double sum = p * own[0] + 2 * m * own[1] + r * own[2], product = (own[0] * own[2] - own[1] * own[1]) / det;
    double inside = sum * sum / 4 - product, q = sum / 2 + (inside > 0 ? sqrt(inside) : 0.0);
    return largest * q / (1 + q);
}

/* No set that holds a base gains more from an element. */
static double marginal_beyond(const Seers *s, int64_t e, const double *base, double before) {
    double matrix[MOST_ENTRIES];
    int entries = entries_at(s);
    const double *own = s->information + e * entries;
    for (int k = 0; k < entries; k++) matrix[k] = base[k] + own[k];
    double gain = before - criterion_at(s, matrix);
    if (s->criterion == TRACE && s->dimension == 2) {
        double other = s->weight * lower_rank(base, own);
        gain = other > gain ? other : gain;
    }
    return gain * (1 + MARGIN) + s->error;
}

/* Search sets that hold `base`, whose elements cost `paid`, and elements of the robots of `left`. */
static void explore(Search *search, uint64_t left, const double *base, double paid) {
    const Seers *s = search->seers;
    if (--search->nodes < 0) return;
    double before = criterion_at(s, base), worth = s->baseline - before - paid, more = 0.0, most = 0.0;
    if (worth > search->best) {
        search->best = worth;
        memcpy(search->found, search->chosen, sizeof search->found);
    }
    int pick = -1;
    for (uint64_t rest = left; rest; rest &= rest - 1) {
        int i = lowest(rest);
        double largest = 0.0;
        for (int64_t e = s->first[i]; e < s->first[i + 1]; e++) {
            double gain = marginal_beyond(s, e, base, before) - search->prices[e];
            largest = gain > largest ? gain : largest;
        }
        more += largest;
        if (largest > most) most = largest, pick = i;
        if (!(largest > 0.0)) left &= ~(1ULL << i);
    }
    if (pick < 0 || worth + more <= search->best + search->tolerance) return;
    left &= ~(1ULL << pick);
    double matrix[MOST_ENTRIES];
    int entries = entries_at(s);
    for (int64_t e = s->first[pick]; e < s->first[pick + 1]; e++) {
        if (!(marginal_beyond(s, e, base, before) > search->prices[e])) continue;
        for (int k = 0; k < entries; k++) matrix[k] = base[k] + s->information[e * entries + k];
        search->chosen[pick] = e;
        explore(search, left, matrix, paid + search->prices[e]);
        search->chosen[pick] = -1;
    }
    explore(search, left, base, paid);
}

double largest_excess(const Seers *seers, const double *prices, double floor, double tolerance, int64_t most, int64_t *chosen) {
    Search search = {.seers = seers, .prices = prices, .best = floor, .tolerance = tolerance, .nodes = most};
    for (int i = 0; i < 64; i++) search.chosen[i] = search.found[i] = -1;
    explore(&search, seers->robots == 64 ? ~0ULL : (1ULL << seers->robots) - 1, seers->prior, 0.0);
    for (int i = 0; i < seers->robots; i++) chosen[i] = search.found[i];
    return search.nodes < 0 ? INFINITY : search.best + tolerance;
}
