/* How low the level of a set of robots can be: bounds by copies of its robots.

   The level is concave in the information: the value itself, or the inverse of the error. A set of k robots adds the average of
   k copies of each, so its level is at least the average of theirs. */
#include <math.h>
#include <stdlib.h>

#include "group_search.h"
#include "team.h"

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

double value_of_copies(const Search *s, const double *sums, double times, int i) {
    add_information(s->q.team, sums, times, i, s->spare);
    return value_of(s->q.team, s->spare);
}

double level_of_copies(const Search *s, const double *sums, double times, int i) { return level_of(s, value_of_copies(s, sums, times, i)); }

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

/* What robots that may sense weigh besides those that sense for sure: they add to their level, at least what copies of each do, and nobody adds nothing. */
static double weigh_more(Search *s, Node *node, int fixed) {
    for (; node->most > fixed; node->most--) {
        int more = node->most - fixed, count = 0;
        for (int i = 0; i < s->robots; i++)
            if (MAY_SENSE(node->state[i])) s->sorted[count++] = s->weight[i] = level_of_copies(s, node->sums, more, i);
        if (sum_of_least(s->sorted, count, more) < more * s->q.level * (1 + ROUNDING)) break;
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
        if (fresh) node->worth[i] = value_of_copies(s, node->sums, 1, i);
        if (node->most == fixed || node->worth[i] >= s->q.threshold) node->state[i] &= ~SENSES;
        else open++;
    }
    if (node->most > fixed + open) node->most = fixed + open;
    double room = weigh_more(s, node, fixed);
    for (int i = 0; i < s->robots && node->most == fixed; i++)
        if (MAY_SENSE(node->state[i])) node->state[i] &= ~SENSES;
    return room;
}
