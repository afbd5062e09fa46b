/* Sets of one size, and groups of given sizes whose best one is weak, by exchanges of robots. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "records.h"
#include "sets.h"
#include "team.h"

typedef struct {
    const Team *team;
    int64_t *home;              /* (robots) group of each, 0 for those that are blinded */
    const uint8_t *must;        /* (robots) whether it cannot be blinded */
    int groups;
    double *sums, *values, *one;
} Family;

/* Value of a group once `leaves` is replaced by `enters`. */
static double exchanged(const Family *f, int64_t group, int64_t leaves, int64_t enters) {
    int width = f->team->targets * entries_of(f->team);
    const double *sums = f->sums + group * width, *less = f->team->information + (size_t)leaves * width;
    const double *more = f->team->information + (size_t)enters * width;
    for (int t = 0; t < width; t++) f->one[t] = sums[t] - less[t] + more[t];
    return value_of(f->team, f->one);
}

/* The exchange that leaves the least best group, both groups below what the best one was; 0 where there is none. Among
   those that leave another group the best one the sum of both decides, with the weight `share`. */
static int best_exchange(const Family *f, int64_t top, double share, int64_t *leaves, int64_t *enters) {
    double second = -INFINITY, lowest = INFINITY, goal = f->values[top] - 1e-12 * fabs(f->values[top]);
    for (int g = 1; g <= f->groups; g++)
        if (g != top) second = fmax(second, f->values[g]);
    for (int64_t i = 0; i < f->team->robots; i++) {
        if (f->home[i] != top) continue;
        for (int64_t e = 0; e < f->team->robots; e++) {
            if (f->home[e] == top || (f->home[e] == 0 && f->must[i])) continue;
            double mine = exchanged(f, top, i, e);
            if (mine >= goal) continue;
            double other = f->home[e] > 0 ? exchanged(f, f->home[e], e, i) : -INFINITY;
            if (other >= goal) continue;
            double larger = fmax(mine, other), score = fmax(larger, second) + share * (mine + larger);
            if (score < lowest) lowest = score, *leaves = i, *enters = e;
        }
    }
    return lowest < INFINITY;
}

/* Exchange a robot of the best group for one elsewhere, the best pair each time, while the best group weakens. *value: of
   the best group; returns 1 at the end, 0 after so many `steps`, -1 where memory is short. */
EXPORTED int exchange_groups(const Team *team, int groups, int64_t *home, const uint8_t *must, double share, int64_t steps, double *value) {
    int width = team->targets * entries_of(team), finished = 0;
    double *memory = malloc(((size_t)(groups + 2) * width + (size_t)groups + 1) * sizeof(double));
    if (!memory) return -1;
    Family f = {team, home, must, groups, memory, memory + (size_t)(groups + 2) * width, memory + (size_t)(groups + 1) * width};
    for (int g = 0; g <= groups; g++) memcpy(f.sums + g * width, team->prior, (size_t)width * sizeof(double));
    for (int64_t i = 0; i < team->robots; i++) add_information(team, f.sums + home[i] * width, 1.0, i, f.sums + home[i] * width);
    f.values[0] = -INFINITY;
    for (int g = 1; g <= groups; g++) f.values[g] = value_of(team, f.sums + g * width);
    while (1) {
        int64_t top = 0, leaves = -1, enters = -1;
        for (int g = 1; g <= groups; g++)
            if (f.values[g] > f.values[top]) top = g;
        *value = f.values[top];
        if (steps-- <= 0) break;
        if (!best_exchange(&f, top, share, &leaves, &enters)) {
            finished = 1;
            break;
        }
        int64_t other = home[enters];
        double *mine = f.sums + top * width, *theirs = f.sums + other * width;
        for (int t = 0; t < width; t++) {
            double change = team->information[enters * width + t] - team->information[leaves * width + t];
            mine[t] += change, theirs[t] -= change;
        }
        home[leaves] = other, home[enters] = top;
        f.values[top] = value_of(team, mine);
        if (other > 0) f.values[other] = value_of(team, theirs);
    }
    free(memory);
    return finished;
}

enum { BARRED, INSIDE, OUTSIDE };

/* Exchange one robot inside for one outside, the best pair each time, while that lowers the value of the set. `kept`
   (targets, entries): information without the robots inside; `where` (robots) is changed in place. Returns 1 at the end, 0
   after so many `steps`, -1 where memory is short. */
EXPORTED int exchange_robots(const Team *team, const double *kept, int8_t *where, int64_t steps) {
    int width = team->targets * entries_of(team), finished = 0;
    double *sums = malloc(2 * (size_t)width * sizeof(double)), *changed = sums + width;
    if (!sums) return -1;
    memcpy(sums, kept, (size_t)width * sizeof(double));
    for (int64_t i = 0; i < team->robots; i++)
        if (where[i] == INSIDE) add_information(team, sums, 1.0, i, sums);
    double value = value_of(team, sums), scale = fabs(value);
    memcpy(changed, sums, (size_t)width * sizeof(double));
    for (int64_t i = 0; i < team->robots; i++)
        if (where[i] == OUTSIDE) add_information(team, changed, 1.0, i, changed);
    scale = fmax(scale, fabs(value_of(team, changed))); /* less than 1e-12 of it is rounding */
    while (steps-- > 0) {
        int64_t leaves = -1, enters = -1;
        double lowest = value - 1e-12 * scale;
        for (int64_t i = 0; i < team->robots; i++) {
            if (where[i] != INSIDE) continue;
            for (int64_t e = 0; e < team->robots; e++) {
                if (where[e] != OUTSIDE) continue;
                add_information(team, sums, -1.0, i, changed);
                add_information(team, changed, 1.0, e, changed);
                double other = value_of(team, changed);
                if (other < lowest) lowest = other, leaves = i, enters = e;
            }
        }
        if (leaves < 0) {
            finished = 1;
            break;
        }
        where[leaves] = OUTSIDE, where[enters] = INSIDE;
        add_information(team, sums, -1.0, leaves, sums);
        add_information(team, sums, 1.0, enters, sums);
        value = lowest;
    }
    free(sums);
    return finished;
}
