/* Groups that an attack may leave, and exact covers of the team by them. */
#pragma once
#include "sets.h"

/* A node of the list of groups: robots inside, robots outside, those next to one inside; links between the first two. */
typedef struct {
    uint64_t inside, outside, near;
    int64_t cut;
} Branch;

/* Groups that an attack may leave; as bit masks of 64 bits where they are `wide`, of 32 elsewhere. */
typedef struct {
    int64_t count, wide;
    void *groups;
    uint8_t *cuts, *blinded;           /* links that leave each, and robots to blind in it */
} Columns;

enum { PART = 12 };

/* Integer duals, in units of a link: `sums` over sets of the first PART robots, of the next, and so on; `unit` of a link,
   `blinding` of a blinded robot. */
typedef struct {
    const int64_t *sums;               /* (parts, 2**PART) */
    int64_t unit, blinding;
} Duals;

/* A level of the search of covers. */
typedef struct {
    int64_t room[3];                   /* reduced cost, blinded robots and links that are left */
    int64_t start, end, position;      /* of the columns that fit, in `fitting` */
    int32_t robot, column;             /* the robot that is covered next, -1 until chosen; the column tried */
} Level;

/* A search of covers. Columns are sorted by reduced cost. */
typedef struct {
    int64_t robots, words, room;       /* `words` of 64 robots each; `room` for columns that fit */
    const uint64_t *groups;            /* (columns, words) */
    const int64_t *costs;              /* (columns, 3) reduced cost, blinded robots, links, each >= 0 */
    int32_t *fitting;                  /* (room) those that fit at each level, one after the other */
    Level *levels;                     /* (robots + 2) */
    uint64_t *left;                    /* (robots + 2, words) robots not covered */
    int64_t *counts;                   /* (robots) spare */
    int64_t depth, nodes, most_nodes;  /* depth -1 at the end; nodes so far, and before a pause */
} Cover;

/* List connected sets that at most `most` links leave, none of them protected; each grows from its lowest robot, and a
   robot next to it is taken in or left out, which costs its links. At most 63 robots. Goes on from `position`: robots begun
   with, depth of the stack (2 robots + 2). Ends after `steps` or `room` sets; returns how many were written. */
EXPORTED int64_t list_groups(int robots, const uint64_t *neighbours, const uint64_t *protected_links, int64_t most, Branch stack[],
                             int64_t *position, int64_t steps, int64_t room, uint64_t *groups, uint16_t *cuts);
/* The column of least reduced cost with each robot, (robots) where it is negative, else -1; returns the least of all. */
EXPORTED int64_t price(int robots, const Columns *columns, const Duals *duals, int64_t *cheapest);
/* The columns of a reduced cost of at most `gap`, as many as there is `room` for; returns how many there are. */
EXPORTED int64_t within_gap(const Columns *columns, const Duals *duals, int64_t gap, int64_t room, int64_t *chosen, int64_t *costs);
/* At most `size` robots of `set` sense in a group that has those of `protected` in `set`. Raises the robots to blind, and keeps
   the columns in which at most `most` are, in place; returns how many. */
EXPORTED int64_t restrict_columns(Columns *columns, uint64_t set, int size, uint64_t protected, int most);
/* Go on to the next cover; at most `steps` columns are looked at before a pause. */
EXPORTED int next_cover(Cover *cover, int64_t steps);
