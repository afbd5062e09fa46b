/* Disjoint sets of given sizes from lists, all worth less than a threshold: an exact search with costs and memory.

   Robots are decided one by one: each either lies in the next set, whose first robot it is, or in the rest, the robots that are
   blinded or left alone. A choice that costs more than the room has no completion. What is left to do depends only on which
   robots are decided and which sizes remain, so states that failed once are remembered. */
#include <math.h>
#include <string.h>

#include "sets_of_size.h"

enum { REST = -1, NONE = -2 };
enum { MOST_REMEMBERED = 8 }; /* sizes of a state that fit into one key beside the rest's two numbers, six bits each */

/* The largest value of a robot in the rest once its strongest ones that may be are blinded; infinitely small if none is left. */
static double left_alone(const DisjointSets *d, uint64_t rest) {
    int64_t blinded = d->n_blinded;
    for (; rest; rest &= rest - 1) {
        int robot = lowest(rest);
        if (blinded > 0 && !(d->must >> robot & 1)) blinded--;
        else return d->single[robot];
    }
    return -INFINITY;
}

/* A key of what remains to be chosen; never 0. */
static uint64_t remaining(const DisjointSets *d, const Choice *at) {
    uint64_t key = 1;
    for (int c = 0; c < d->classes; c++) key = key << 6 | (uint64_t)at->counts[c];
    return (key << 6 | (uint64_t)at->places) << 6 | (uint64_t)at->kept;
}

static uint64_t *remembered(const DisjointSets *d, uint64_t decided, uint64_t key) {
    uint64_t h = decided * 0x9E3779B97F4A7C15ULL ^ key * 0xC2B2AE3D27D4EB4FULL;
    h ^= h >> 29, h *= 0xBF58476D1CE4E5B9ULL, h ^= h >> 32;
    return d->memory + 2 * (h & (uint64_t)(d->remembered - 1));
}

/* What to do next with the first undecided robot: a set, REST or NONE. */
static int64_t next_option(const DisjointSets *d, Choice *at, int64_t *looked) {
    int robot = lowest(~at->decided);
    if (at->option == -1) {
        at->option = 0, at->next = d->starts[robot];
        int must = (int)(d->must >> robot & 1);
        if (at->places > 0 && at->kept >= must && at->cost + d->rest_costs[robot] < d->room) return REST;
    }
    while (at->option < d->classes) {
        int64_t e = at->next;
        if (at->counts[at->option] == 0 || e >= d->starts[at->option * (d->robots + 1) + robot + 1] || at->cost + d->costs[e] >= d->room) {
            if (++at->option < d->classes) at->next = d->starts[at->option * (d->robots + 1) + robot];
            continue;
        }
        at->next++, ++*looked;
        if (!(d->masks[e] & at->decided) && d->values[e] < d->threshold) return e;
    }
    return NONE;
}

static void choose(const DisjointSets *d, const Choice *at, Choice *child, int64_t chosen) {
    int32_t *counts = child->counts;
    *child = *at;
    child->counts = counts, child->option = -1;
    memcpy(counts, at->counts, (size_t)d->classes * sizeof(int32_t));
    if (chosen == REST) {
        int robot = lowest(~at->decided);
        uint64_t bit = (uint64_t)1 << robot;
        child->decided |= bit, child->rest |= bit, child->places--;
        child->kept -= (int32_t)(d->must >> robot & 1);
        child->cost += d->rest_costs[robot];
    } else {
        child->decided |= d->masks[chosen], counts[at->option]--;
        child->cost += d->costs[chosen], child->value = fmax(at->value, d->values[chosen]);
    }
}

/* All sets are chosen: keep them where they are better. */
static void note(DisjointSets *d, const Choice *last) {
    uint64_t everyone = ((uint64_t)1 << d->robots) - 1, rest = last->rest | (everyone & ~last->decided);
    if (size_of(rest & d->must) > d->rest - d->n_blinded) return;
    double value = fmax(last->value, left_alone(d, rest));
    if (value >= d->threshold) return;
    d->threshold = value, d->found = 0;
    for (Choice *at = d->stack; at < last; at++)
        if (at->chosen >= 0) d->best[d->found++] = at->chosen;
}

int search_disjoint(DisjointSets *d, int64_t work) {
    int remembers = d->classes <= MOST_REMEMBERED;
    int64_t looked = 0;
    while (d->depth >= 0) {
        Choice *at = d->stack + d->depth, *child = at + 1;
        if (looked >= work) return 0;
        looked++;
        at->chosen = next_option(d, at, &looked);
        if (at->chosen == NONE) {
            /* If the sets so far are no longer below the threshold, the state itself has not failed. */
            if (remembers && d->depth > 1 && at->value < d->threshold) {
                uint64_t key = remaining(d, at), *slot = remembered(d, at->decided, key);
                slot[0] = at->decided, slot[1] = key;
            }
            d->depth--;
            continue;
        }
        choose(d, at, child, at->chosen);
        if (child->value >= d->threshold) continue;
        int left = 0;
        for (int c = 0; c < d->classes; c++) left += child->counts[c];
        if (left == 0) {
            note(d, child);
            continue;
        }
        if (remembers) {
            uint64_t key = remaining(d, child), *slot = remembered(d, child->decided, key);
            if (slot[0] == child->decided && slot[1] == key) continue;
        }
        d->depth++;
    }
    return 1;
}
