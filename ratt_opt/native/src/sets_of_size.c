/* Sets of one size that are worth less than a threshold, one after the other.

   Depth first. The level of a set is concave in its information (levels.c), so a set of q more robots has at least the average
   level of q copies of each of them. Candidates come by these levels, the lowest first, or, if robots have costs, as they are
   given, and sets cost less than a limit. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "group_search.h"
#include "sets_of_size.h"

enum { FINISHED, PAUSED, FOUND };

/* A partial set: its candidates, and which of them comes next. */
typedef struct {
    int count, next, fresh;
    double spent, bound; /* costs of the robots chosen; level that no set of it is below */
} Partial;

struct SetSearch {
    SetQuestion *q;
    int robots, width, depth;
    double before;
    int64_t visited;
    Partial *partial;       /* (size + 1) */
    int *candidates;        /* (size + 1, robots) */
    double *sums, *level;   /* (size + 1, width); (size + 1, robots) of copies of each candidate */
    double *least, *cheapest; /* (size + 1, robots) what sets whose first robot is the candidate add up to at least: levels, costs */
    double *both, *sorted, *spare; /* (robots) twice, (width) */
};

/* Drop the candidates with which no set has scores that add up to less than 0; 0 where too few are left. */
static int drop(SetSearch *s, const double *score, int left) {
    Partial *at = s->partial + s->depth;
    int *candidates = s->candidates + (size_t)s->depth * s->robots, kept = 0;
    double *level = s->level + (size_t)s->depth * s->robots;
    memcpy(s->sorted, score, (size_t)at->count * sizeof(double));
    double others = sum_of_least(s->sorted, at->count, left - 1);
    if (others + s->sorted[left - 1] >= 0.0) return 0;
    for (int p = 0; p < at->count; p++) {
        if (score[p] + others >= 0.0) continue;
        candidates[kept] = candidates[p], level[kept++] = level[p];
    }
    at->count = kept;
    return kept >= left;
}

/* sums[p]: value p and the `others` least after it; infinite where there are fewer. `kept` (others) is spare. */
static void least_from(const double *values, int count, int others, double *kept, double *sums) {
    double total = 0.0;
    for (int p = count - 1, number = 0; p >= 0; p--) {
        sums[p] = number < others ? INFINITY : total + values[p];
        if (others == 0 || (number == others && values[p] >= kept[number - 1])) continue;
        int k = number < others ? number : others - 1;
        if (number == others) total -= kept[k];
        else number++;
        for (; k > 0 && kept[k - 1] > values[p]; k--) kept[k] = kept[k - 1];
        kept[k] = values[p], total += values[p];
    }
}

/* Value the candidates, drop those that no set has, and sort the others unless they have costs; 0 where no set is left. */
static int narrow(SetSearch *s, int left) {
    Partial *at = s->partial + s->depth;
    size_t row = (size_t)s->depth * s->robots;
    int *candidates = s->candidates + row;
    double *level = s->level + row, enough = s->q->level * (1 + ROUNDING);
    for (int p = 0; p < at->count; p++) {
        add_information(s->q->team, s->sums + (size_t)s->depth * s->width, left, candidates[p], s->spare);
        double value = value_of(s->q->team, s->spare);
        level[p] = s->q->team->criterion == LOG_DET ? value : 1.0 / (s->before - value);
        s->both[p] = level[p] - enough;
    }
    if (!drop(s, s->both, left)) return 0;
    for (int p = 0; p < at->count && s->q->costs; p++) s->both[p] = s->q->costs[candidates[p]] - (s->q->limit - at->spent) / left;
    if (s->q->costs && !drop(s, s->both, left)) return 0;
    for (int p = 1; p < at->count && !s->q->in_order; p++) {
        int robot = candidates[p], k = p;
        double own = level[p];
        for (; k > 0 && level[k - 1] > own; k--) level[k] = level[k - 1], candidates[k] = candidates[k - 1];
        level[k] = own, candidates[k] = robot;
    }
    least_from(level, at->count, left - 1, s->sorted, s->least + row);
    if (!s->q->costs) return 1;
    for (int p = 0; p < at->count; p++) s->both[p] = s->q->costs[candidates[p]];
    least_from(s->both, at->count, left - 1, s->sorted, s->cheapest + row);
    return 1;
}

/* Go to the next candidate with which sets may be below and cheap enough; the level that none of these is below, infinite if there
   is none. */
static double next_level(const SetSearch *s, int depth) {
    Partial *at = s->partial + depth;
    int left = (int)s->q->size - depth;
    const double *least = s->least + (size_t)depth * s->robots, *cheapest = s->cheapest + (size_t)depth * s->robots;
    for (; at->next + left <= at->count; at->next++) {
        double level = least[at->next] / left;
        if (level >= s->q->level * (1 + ROUNDING)) {
            if (!s->q->in_order) break; /* candidates are sorted */
            continue;
        }
        if (!s->q->costs || at->spent + cheapest[at->next] < s->q->limit) return level;
    }
    return INFINITY;
}

/* The next robot that is the last of a set; 1 if there is one. */
static int complete(SetSearch *s, uint8_t *chosen, double *value) {
    Partial *at = s->partial + s->depth;
    const int *candidates = s->candidates + (size_t)s->depth * s->robots;
    while (at->next < at->count) {
        int robot = candidates[at->next++];
        if (s->q->costs && at->spent + s->q->costs[robot] >= s->q->limit) continue;
        add_information(s->q->team, s->sums + (size_t)s->depth * s->width, 1.0, robot, s->spare);
        *value = value_of(s->q->team, s->spare);
        if (!(*value < s->q->threshold)) continue;
        memset(chosen, 0, (size_t)s->robots);
        for (int d = 0; d <= s->depth; d++) chosen[s->candidates[(size_t)d * s->robots + s->partial[d].next - 1]] = 1;
        return 1;
    }
    return 0;
}

static int step(SetSearch *s, uint8_t *chosen, double *value) {
    Partial *at = s->partial + s->depth, *child = at + 1;
    int left = (int)s->q->size - s->depth;
    if (at->fresh) {
        s->visited++;
        at->fresh = 0, at->next = 0;
        if (left > 1 && !narrow(s, left)) at->count = 0;
    }
    if (left == 1) {
        if (complete(s, chosen, value)) return FOUND;
        s->depth--;
        return PAUSED;
    }
    double bound = next_level(s, s->depth);
    if (bound == INFINITY) {
        s->depth--;
        return PAUSED;
    }
    const int *candidates = s->candidates + (size_t)s->depth * s->robots;
    int robot = candidates[at->next++];
    child->count = at->count - at->next, child->next = 0, child->fresh = 1;
    child->bound = bound;
    child->spent = at->spent + (s->q->costs ? s->q->costs[robot] : 0.0);
    memcpy(s->candidates + (size_t)(s->depth + 1) * s->robots, candidates + at->next, (size_t)child->count * sizeof(int));
    double *sums = s->sums + (size_t)s->depth++ * s->width;
    add_information(s->q->team, sums, 1.0, robot, sums + s->width);
    return PAUSED;
}

void close_sets(SetSearch *s) {
    if (!s) return;
    free(s->partial), free(s->candidates), free(s->sums), free(s);
}

SetSearch *open_sets(SetQuestion *question) {
    SetSearch *s = calloc(1, sizeof(SetSearch));
    if (!s) return NULL;
    size_t n = (size_t)question->team->robots, rows = (size_t)question->size + 1;
    size_t width = (size_t)question->team->targets * (size_t)entries_of(question->team);
    s->q = question, s->robots = (int)n, s->width = (int)width, s->before = error_before(question->team);
    s->partial = calloc(rows, sizeof(Partial));
    s->candidates = malloc((rows * n + 1) * sizeof(int));
    s->sums = malloc((rows * (width + 3 * n) + 2 * n + width) * sizeof(double));
    if (!s->partial || !s->candidates || !s->sums) {
        close_sets(s);
        return NULL;
    }
    s->level = s->sums + rows * width, s->least = s->level + rows * n, s->cheapest = s->least + rows * n;
    s->both = s->cheapest + rows * n, s->sorted = s->both + n, s->spare = s->sorted + n;
    memcpy(s->sums, question->start, width * sizeof(double));
    s->partial->fresh = 1, s->partial->bound = -INFINITY;
    s->partial->count = (int)question->candidates;
    for (int p = 0; p < s->partial->count; p++) s->candidates[p] = (int)question->order[p];
    if (s->partial->count < question->size || question->size < 1) s->depth = -1;
    return s;
}

int next_set_below(SetSearch *s, int64_t nodes, uint8_t *chosen, double *value, int64_t *progress) {
    int code = PAUSED;
    int64_t stop = s->visited + nodes;
    while (code == PAUSED && s->depth >= 0 && s->visited < stop) code = step(s, chosen, value);
    *progress = s->visited;
    return s->depth < 0 && code != FOUND ? FINISHED : code;
}

int list_sets_below(SetSearch *s, int64_t nodes, int64_t room, uint8_t *chosen, uint64_t *masks, double *values, int64_t *count,
                    int64_t *progress) {
    int code = PAUSED;
    int64_t stop = s->visited + nodes;
    while (code != FINISHED && s->visited < stop && *count < room) {
        code = next_set_below(s, stop - s->visited, chosen, values + *count, progress);
        if (code != FOUND) continue;
        masks[*count] = 0;
        for (int i = 0; i < s->robots; i++)
            if (chosen[i]) masks[*count] |= (uint64_t)1 << i;
        ++*count;
    }
    return code == FINISHED ? FINISHED : PAUSED;
}

double least_open(const SetSearch *s) {
    double level = INFINITY;
    for (int d = 0; d <= s->depth; d++) {
        const Partial *at = s->partial + d;
        double own = at->fresh || d == s->q->size - 1 ? at->bound : next_level(s, d);
        level = fmin(level, own);
    }
    if (s->q->team->criterion == LOG_DET || level == INFINITY || level == -INFINITY) return level;
    return level > 0.0 ? s->before - 1.0 / level : -INFINITY;
}
