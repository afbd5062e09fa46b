/* Which sets of robots are worth less than a threshold, and the largest of these inside each set. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "team.h"

enum { LEAF = 4, BLOCK = 12 }; /* robots of the sets that are valued at once, and of those that one call may not split */

typedef struct {
    const Team *team;
    double threshold, next;     /* `next`: the least value met that is not below, */
    int64_t next_set;           /* and its set */
    const double *all;          /* (BLOCK + 1, targets * entries) information of all of the first b robots */
    const double *leaves;       /* (targets, entries, 1 << LEAF) information of each set of the first LEAF robots */
    double *sums;               /* (BLOCK + 1, targets * entries) posterior information on the way down */
    double *top;                /* (targets * entries) */
    uint8_t *sizes;
    const uint8_t *blinded;     /* (BLOCK + 1, 1 << BLOCK), see `mark_below` */
    int leaf, left;             /* `left`: robots that may still be blinded among those of the block */
} Visit;

static void meet(Visit *v, double value, uint64_t set) {
    if (value < v->next) v->next = value, v->next_set = (int64_t)set;
}

static void mark_leaves(Visit *v, uint64_t set, const double *sums) {
    double values[1 << LEAF], spare[1 << LEAF];
    int count = 1 << v->leaf, width = v->team->targets * entries_of(v->team);
    if (v->team->dimension == 2) planar_values(v->team, count, v->leaves, sums, values, spare);
    for (int k = 0; k < count && v->team->dimension != 2; k++) {
        for (int t = 0; t < width; t++) v->top[t] = sums[t] + v->leaves[t * count + k];
        values[k] = value_of(v->team, v->top);
    }
    for (int k = 0; k < count; k++) {
        int below = values[k] < v->threshold;
        v->sizes[set + (uint64_t)k] = below ? (uint8_t)(size_of(set) + size_of((uint64_t)k) + 1) : 0;
        if (!below) meet(v, values[k], set + (uint64_t)k);
    }
}

/* Mark `set` together with every set of the first `bit` robots. `least`, `most`: values without and with all of them. */
static void mark(Visit *v, int bit, uint64_t set, const double *sums, double least, double most) {
    uint64_t count = (uint64_t)1 << bit;
    if (v->blinded[(bit << BLOCK) + (int)((set & ((1 << BLOCK) - 1)) >> bit)] > v->left) {
        memset(v->sizes + set, 0, count);
        return;
    }
    if (most < v->threshold) {
        int size = size_of(set) + 1;
        for (uint64_t k = 0; k < count; k++) v->sizes[set + k] = (uint8_t)(size + size_of(k));
        return;
    }
    if (least >= v->threshold) {
        memset(v->sizes + set, 0, count);
        meet(v, least, set);
        return;
    }
    if (bit <= v->leaf) {
        mark_leaves(v, set, sums);
        return;
    }
    int width = v->team->targets * entries_of(v->team), robot = bit - 1;
    const double *all = v->all + (size_t)robot * width;
    double *with = v->sums + (size_t)robot * width;
    for (int t = 0; t < width; t++) v->top[t] = sums[t] + all[t];
    mark(v, robot, set, sums, least, value_of(v->team, v->top));
    add_information(v->team, sums, 1.0, robot, with);
    mark(v, robot, set | (uint64_t)1 << robot, with, value_of(v->team, with), most);
}

int mark_below(const Team *team, double threshold, int64_t first, int64_t last, const uint8_t *outside, const uint8_t *inside, int most,
               uint8_t *sizes, double *next, int64_t *next_set) {
    int bits = team->robots < BLOCK ? team->robots : BLOCK, leaf = bits < LEAF ? bits : LEAF, width = team->targets * entries_of(team);
    size_t rows = 2 * (size_t)(BLOCK + 1) + 2 + ((size_t)1 << LEAF);
    double *memory = calloc(rows * (size_t)width, sizeof(double));
    if (!memory) return 1;
    double *all = memory, *sums = all + (size_t)(BLOCK + 1) * width, *top = sums + (size_t)(BLOCK + 1) * width;
    double *start = top + width, *leaves = start + width;
    for (int i = 0; i < bits; i++) add_information(team, all + i * width, 1.0, i, all + (i + 1) * width);
    int count = 1 << leaf;
    for (int k = 1; k < count; k++) {
        int robot = lowest((uint64_t)k);
        for (int t = 0; t < width; t++)
            leaves[t * count + k] = leaves[t * count + (k & (k - 1))] + team->information[(size_t)robot * width + t];
    }
    Visit v = {team, threshold, *next, *next_set, all, leaves, sums, top, sizes, inside, leaf, 0};
    for (int64_t block = first; block < last; block++) {
        v.left = most - outside[block];
        if (v.left < 0) {
            memset(sizes + (block << bits), 0, (size_t)1 << bits);
            continue;
        }
        memcpy(start, team->prior, (size_t)width * sizeof(double));
        for (uint64_t rest = (uint64_t)block; rest; rest &= rest - 1) add_information(team, start, 1.0, bits + lowest(rest), start);
        double least = value_of(team, start);
        for (int t = 0; t < width; t++) top[t] = start[t] + all[bits * width + t];
        mark(&v, bits, (uint64_t)block << bits, start, least, value_of(team, top));
    }
    *next = v.next, *next_set = v.next_set;
    free(memory);
    return 0;
}
