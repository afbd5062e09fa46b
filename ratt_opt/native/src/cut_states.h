/* Partial cuts of two parts of a network, joined. */
#pragma once

#include "sets.h"

/* Partial cuts that leave the same classes. `map` : (classes) which each becomes, or -1. */
typedef struct {
    int64_t classes, count;
    const int64_t *map, *states;       /* (count, 2 + classes) weight cut, number, sizes */
} CutStates;

/* Joined states, none as good as another. `room` : (classes) of each; states cut at most `most_cut`. */
typedef struct {
    int64_t classes, most_cut, capacity, count;
    const int64_t *room;
    int64_t *states;                   /* (capacity, 3 + classes) weight cut, numbers of both states, sizes */
} CutFront;

/* Join states of `a` from `start` on with all of `b`, both by ascending cuts; where it stopped: at the end, after `pairs`,
   or as room in the front was short. */
EXPORTED int64_t join_cut_states(CutFront *f, const CutStates *a, const CutStates *b, int64_t start, int64_t pairs);
