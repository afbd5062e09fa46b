/* How low the level of a set of robots can be: bounds by copies of one or two of its robots.

   The level is concave in the information: the value itself, or the inverse of the error. A set of k robots adds the average of
   k copies of each, and of k / 2 copies of each pair, so its level is at least the average of theirs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "group_search.h"
#include "team.h"

enum { RATIOS = 5 };             /* tried to compare the weights of two sizes */

double error_before(const Team *team) {
    double total = 0.0;
    for (int j = 0; j < team->targets; j++) total += team->weights[j] * team->before[j];
    return team->criterion == LARGEST ? team->before_all : total;
}

static double level_of(const Search *s, double value) { return s->q.team->criterion == LOG_DET ? value : 1.0 / (s->before - value); }

double level_of_threshold(const Team *team, double threshold) {
    if (team->criterion == LOG_DET) return threshold + 1e-12 * fabs(threshold);
    double before = error_before(team), error = before - threshold - 1e-12 * (fabs(before) + fabs(threshold));
    return error > 0.0 ? 1.0 / error : INFINITY;
}

double value_of_copies(const Search *s, const double *sums, double times, int i, int j) {
    add_information(s->q.team, sums, times, i, s->spare);
    if (j >= 0) add_information(s->q.team, s->spare, times, j, s->spare);
    return value_of(s->q.team, s->spare);
}

double level_of_copies(const Search *s, const double *sums, double times, int i, int j) {
    return level_of(s, value_of_copies(s, sums, times, i, j));
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

double sum_of_least(double *values, int length, int count) {
    double sum = 0.0;
    qsort(values, (size_t)length, sizeof(double), compare);
    for (int p = 0; p < count; p++) sum += values[p];
    return sum;
}

/* Levels of size / 2 copies of two robots, of size copies of one on the diagonal; for each robot the others by these. */
static void fill(const Search *s, int size) {
    int n = s->robots;
    double *levels = s->q.levels + (size_t)size * n * n;
    const double *prior = s->q.team->prior;
    for (int i = 0; i < n; i++) {
        levels[i * n + i] = level_of_copies(s, prior, size, i, -1);
        for (int j = 0; j < i; j++) levels[i * n + j] = levels[j * n + i] = level_of_copies(s, prior, size / 2.0, i, j);
    }
    for (int i = 0; i < n; i++) {
        int32_t *near = s->q.near + ((size_t)size * n + i) * n;
        const double *of = levels + i * n;
        for (int j = 0; j < n; j++) {
            int at = j;
            for (; at > 0 && of[near[at - 1]] > of[j]; at--) near[at] = near[at - 1];
            near[at] = j;
        }
    }
    s->q.filled[size] = 1;
}

/* A set of `size` robots that may sense has a level of at least the average of its weights; infinite where it needs others. */
static void weigh_size(const Search *s, const int8_t *state, int size, double *weight) {
    int n = s->robots;
    if (!s->q.filled[size]) fill(s, size);
    for (int i = 0; i < n; i++) {
        if (!(state[i] & SENSES)) continue;
        const double *levels = s->q.levels + ((size_t)size * n + i) * n;
        const int32_t *near = s->q.near + ((size_t)size * n + i) * n;
        double sum = 0.0;
        int count = 0;
        for (int p = 0; p < n && count < size - 1; p++) {
            if (near[p] == i || !(state[near[p]] & SENSES)) continue;
            sum += levels[near[p]];
            count++;
        }
        weight[i] = size == 1 ? levels[i] : count < size - 1 ? INFINITY : sum / (size - 1);
    }
}

/* Values of robots that may sense, side by side. */
static int gather(const Search *s, const int8_t *state, const double *values, double *out) {
    int count = 0;
    for (int i = 0; i < s->robots; i++)
        if (state[i] & SENSES) out[count++] = values[i];
    return count;
}

/* The most that `size` robots weigh below the threshold, by their weights for this size: for any ratio of both weights, a set
   weighs at most the ratio times what its own weights may be, and the largest differences. */
static double most_weight(Search *s, const int8_t *state, int size, double least) {
    int count = gather(s, state, s->weight, s->sorted);
    double most = 0.0;
    qsort(s->sorted, (size_t)count, sizeof(double), compare);
    for (int p = count - size; p < count; p++) most += s->sorted[p];
    if (most <= least) return most; /* no need to look closer */
    weigh_size(s, state, size, s->own);
    double sum = 0.0, sum_own = 0.0, room = size * s->q.level * (1 + ROUNDING);
    for (int i = 0; i < s->robots; i++)
        if (state[i] & SENSES) sum += s->weight[i], sum_own += s->own[i];
    for (int step = 0; step < RATIOS && isfinite(sum_own) && isfinite(room); step++) {
        double ratio = sum / sum_own * (0.5 + 0.25 * step);
        count = 0;
        for (int i = 0; i < s->robots; i++)
            if (state[i] & SENSES) s->sorted[count++] = ratio * s->own[i] - s->weight[i];
        most = fmin(most, ratio * room - sum_of_least(s->sorted, count, size));
    }
    return most;
}

/* Where nobody senses for sure. */
static double weigh_all(Search *s, Node *node) {
    for (; node->most > 0; node->most--) {
        weigh_size(s, node->state, node->most, s->weight);
        int count = gather(s, node->state, s->weight, s->sorted);
        double enough = node->most * s->q.level * (1 + ROUNDING);
        if (count >= node->most && sum_of_least(s->sorted, count, node->most) < enough) break;
    }
    double room = node->most > 0 ? node->most * s->q.level * (1 + ROUNDING) : 0.0;
    int least = node->low - (int)s->q.n_blinded; /* fewer do not sense in any group of the node */
    for (int size = node->most - 1; size > 0 && size >= least; size--) room = fmax(room, most_weight(s, node->state, size, room));
    return room;
}

/* Whether `size` more robots may sense, by pairs. */
static int pairs_may_be_below(Search *s, const Node *node, int size) {
    int n = s->robots, count = 0, *robots = s->order;
    double *levels = s->q.levels; /* of size 0 are none */
    for (int i = 0; i < n; i++)
        if (MAY_SENSE(node->state[i])) robots[count++] = i;
    for (int p = 0; p < count; p++)
        for (int q = 0; q < p; q++)
            levels[p * n + q] = levels[q * n + p] = level_of_copies(s, node->sums, size / 2.0, robots[p], robots[q]);
    for (int p = 0; p < count; p++) {
        int others = 0;
        for (int q = 0; q < count; q++)
            if (q != p) s->sorted[others++] = levels[p * n + q];
        s->own[p] = sum_of_least(s->sorted, others, size - 1) / (size - 1);
    }
    return sum_of_least(s->own, count, size) < size * s->q.level * (1 + ROUNDING);
}

/* Where some sense for sure: others add to their level, at least what copies of each do, and nobody adds nothing. */
static double weigh_more(Search *s, Node *node, int fixed) {
    for (; node->most > fixed; node->most--) {
        int more = node->most - fixed, count = 0;
        for (int i = 0; i < s->robots; i++)
            if (MAY_SENSE(node->state[i])) s->sorted[count++] = s->weight[i] = level_of_copies(s, node->sums, more, i, -1);
        if (sum_of_least(s->sorted, count, more) >= more * s->q.level * (1 + ROUNDING)) continue;
        if (more < 2 || !s->q.levels || pairs_may_be_below(s, node, more)) break;
    }
    double level = level_of(s, value_of(s->q.team, node->sums));
    for (int i = 0; i < s->robots; i++) s->weight[i] -= level;
    return (node->most - fixed) * (s->q.level * (1 + ROUNDING) - level);
}

double weigh(Search *s, Node *node, int fresh) {
    int fixed = 0, open = 0;
    for (int i = 0; i < s->robots; i++) fixed += node->state[i] == SENSES;
    for (int i = 0; i < s->robots; i++) {
        if (!MAY_SENSE(node->state[i])) continue;
        if (fresh) node->worth[i] = value_of_copies(s, node->sums, 1, i, -1);
        if (node->most == fixed || node->worth[i] >= s->q.threshold) node->state[i] &= ~SENSES;
        else open++;
    }
    if (node->most > fixed + open) node->most = fixed + open;
    double room = fixed || !s->q.levels ? weigh_more(s, node, fixed) : weigh_all(s, node);
    for (int i = 0; i < s->robots && node->most == fixed; i++)
        if (MAY_SENSE(node->state[i])) node->state[i] &= ~SENSES;
    return room;
}
