/* Sets of one size, and groups of given sizes whose best one is weak, by exchanges of robots. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sets_of_size.h"

/* Whether an exchange is left to be tried; `pairs` are counted down, and a call ends when none is left. */
enum { UNFINISHED, FINISHED };

static void start_scan(Scan *scan) { *scan = (Scan){0, -1, -1, INFINITY}; }

typedef struct {
    const Team *team;
    int64_t *home;              /* (robots) group of each, 0 for those in none, -1 for those that stay so */
    const uint8_t *must;        /* (robots) whether it stays in some group */
    int groups;
    double *sums, *values, *one;
} Family;

/* Sums and value of a group, always added in the same order: a value depends on the group alone, not on how the
   exchanges came to it, so that none is met twice on the way down. */
static void value_group(Family *f, int64_t group) {
    int width = f->team->targets * entries_of(f->team);
    double *sums = f->sums + group * width;
    memcpy(sums, f->team->prior, (size_t)width * sizeof(double));
    for (int64_t i = 0; i < f->team->robots; i++)
        if (f->home[i] == group) add_information(f->team, sums, 1.0, i, sums);
    f->values[group] = group ? value_of(f->team, sums) : -INFINITY;
}

/* Value of a group once `leaves` is replaced by `enters`. */
static double exchanged(const Family *f, int64_t group, int64_t leaves, int64_t enters) {
    int width = f->team->targets * entries_of(f->team);
    add_information(f->team, f->sums + group * width, -1.0, leaves, f->one);
    add_information(f->team, f->one, 1.0, enters, f->one);
    return value_of(f->team, f->one);
}

/* Look for the exchange that leaves the least best group, both groups below what the best one was, as far as `pairs`
   last. Among those that leave another group the best one the sum of both decides, with the weight `share`. */
static int scan_groups(const Family *f, int64_t top, double share, Scan *scan, int64_t *pairs) {
    double second = -INFINITY, goal = f->values[top] - least_improvement(f->team, f->values[top]);
    for (int g = 1; g <= f->groups; g++)
        if (g != top) second = fmax(second, f->values[g]);
    for (; scan->next < f->team->robots; scan->next++) {
        int64_t i = scan->next;
        if (f->home[i] != top) continue;
        if (*pairs <= 0) return UNFINISHED;
        *pairs -= f->team->robots;
        for (int64_t e = 0; e < f->team->robots; e++) {
            if (f->home[e] == top || f->home[e] < 0 || (f->home[e] == 0 && f->must[i])) continue;
            double mine = exchanged(f, top, i, e);
            if (mine >= goal) continue;
            double other = f->home[e] > 0 ? exchanged(f, f->home[e], e, i) : -INFINITY;
            if (other >= goal) continue;
            double larger = fmax(mine, other), score = fmax(larger, second) + share * (mine + larger);
            if (score < scan->lowest) scan->lowest = score, scan->leaves = i, scan->enters = e;
        }
    }
    return FINISHED;
}

/* Make the exchange that was found; whether both groups are then worth less than the best one was. It is taken back if
   they are not: the improvement was rounding. */
static int exchange_found(Family *f, int64_t top, const Scan *scan) {
    int64_t other = f->home[scan->enters];
    double before = f->values[top];
    f->home[scan->leaves] = other, f->home[scan->enters] = top;
    value_group(f, top), value_group(f, other);
    if (f->values[top] < before && f->values[other] < before) return 1;
    f->home[scan->leaves] = top, f->home[scan->enters] = other;
    value_group(f, top), value_group(f, other);
    return 0;
}

int exchange_groups(const Team *team, int groups, int64_t *home, const uint8_t *must, double share, int64_t pairs, Scan *scan,
                    double *value) {
    int width = team->targets * entries_of(team), finished = UNFINISHED;
    double *memory = malloc(((size_t)(groups + 2) * width + (size_t)groups + 1) * sizeof(double));
    if (!memory) return -1;
    Family f = {team, home, must, groups, memory, memory + (size_t)(groups + 2) * width, memory + (size_t)(groups + 1) * width};
    for (int g = 0; g <= groups; g++) value_group(&f, g);
    while (1) {
        int64_t top = 0;
        for (int g = 1; g <= groups; g++)
            if (f.values[g] > f.values[top]) top = g;
        *value = f.values[top];
        if (scan_groups(&f, top, share, scan, &pairs) == UNFINISHED) break;
        finished = scan->leaves < 0 || !exchange_found(&f, top, scan);
        start_scan(scan);
        if (finished) break;
    }
    free(memory);
    return finished;
}
