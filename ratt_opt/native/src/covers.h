/* The search by covers: conditions that every plan worth more than a level meets, and a search in depth by them. */
#pragma once
#include "elements.h"

/* What forbids an element, or ends a frame: a cover, a sum of covers, or that the element was a dead end. */
enum { BY_COVER, BY_SUM, TRIED };

/* Partitions of the robots that cutting links leaves. */
typedef struct {
    int64_t groups, partitions, widest;
    const uint8_t *members, *inside; /* (groups, robots), (groups, elements) */
    const int64_t *of;               /* (partitions, widest) groups of each, ended by -1 */
    int64_t *order;                  /* (partitions) in which they are tried */
} Ways;

/* Covers by number. */
typedef struct {
    int64_t size, room, groups; /* how many there are and may be; groups of a partition at most */
    uint64_t *left_out;         /* (room, robots) masks of elements */
    int64_t *partition;         /* (room) */
    double *sums;               /* (room, groups, targets, entries) posterior information where the tangents touch */
    double *level;              /* (room) the least level that the cover is true for */
} Covers;

/* Sums of covers by number: what each element counts, of which plans have to count `enough`. */
typedef struct {
    int64_t looked_at;
    const double *terms;  /* (sums, elements) */
    const int64_t *tried; /* (looked_at) */
    double *used;         /* (sums) how often each was of use */
} Sums;

/* A step forbids elements of a robot, because of a cover, a sum or a node that was a dead end. */
typedef struct {
    int64_t kind, what, robot;
    uint64_t gone;
} Step;

/* Frames, which each fix an element, and steps. */
typedef struct {
    int64_t frame, count;  /* the present frame; steps so far */
    const uint64_t *start; /* (robots) masks of what is allowed at first */
    uint64_t *allowed;     /* (robots + 1, robots) in each frame */
    double *strongest;     /* (robots + 1, robots, targets, entries) bounds of what allowed elements tell */
    int64_t *fixed;        /* (robots + 1) the element that each frame fixes */
    int64_t *first;        /* (robots + 2) the first step of each frame */
    Step *steps;           /* (elements + 1) */
    uint64_t *reasons;     /* (elements + 1, robots) masks of the elements forbidden before on which each depends */
    int64_t *since;        /* (elements) the frame in which each was forbidden last */
    int64_t *touched;      /* (robots + 1, robots) the same of robots, in each frame */
    double *activity;      /* (robots) dead ends that depended on a robot's elements */
} Stack;

/* A node of a proof: what ends a frame (robot -1), or a step before the `next` node; the last one is the root.
   `subject`: a cover, a sum, or the node of the dead end; `place`: of an element among its robot's. */
typedef struct {
    int64_t kind, subject, robot, place, next;
} Node;

/* Nodes of a proof in a growing array. */
typedef struct {
    int64_t size, room;
    Node *nodes; /* (room) */
} Nodes;

/* Memory that a call works in. */
typedef struct {
    void *memory;
    double *sums, *values, *more, *after; /* (targets, entries), (targets) */
    double *bound;                        /* (robots, targets, entries) */
    double *order, *price, *most, *rises; /* (elements), (elements), (robots), (robots) */
    uint64_t *conflict;                   /* (robots) */
    int64_t *needs;                       /* (groups) robots to blind, -1: not known */
    uint8_t *blinded, *may, *kept;        /* (groups, robots), (elements) */
} Scratch;

/* Set up memory for some groups, `memory` to be freed; 1 where it is short, else 0. */
int prepare_scratch(Scratch *scratch, const Choices *choices, int64_t groups);

/* Keep further elements of a group, `inside` (elements), while its bound stays at most `level`. `kept`: those kept so
   far, whose bound is at most the level. `sums` (targets, entries) is set to the posterior information at which the bound
   is taken. Returns the price of what is not kept. */
double keep(const Choices *choices, const uint8_t *inside, const double *price, double level, uint8_t *kept, double *sums,
            Scratch *scratch);

/* Add a cover by an attack after which no plan of the frame is worth more than the level; its number, or -1.
   `most`: partitions that are tried. */
int64_t new_cover(const Choices *choices, const Ways *ways, Covers *covers, const Stack *stack, double level, int64_t most,
                  Scratch *scratch);

/* For each group lose targets until the rest is worth at most `level`; `values` (groups, targets) what it can be worth
   for each; `price` (elements); `noise` (groups, targets) factors of the order in which targets are lost. Set: `paid`
   (groups) the price of all elements that see a lost target, infinite if the level is not reached; `out` (groups,
   elements) the group's other elements. 1 where memory is short, else 0. */
EXPORTED int lose_all(const Choices *choices, int64_t groups, const uint8_t *inside, const double *price, const double *values,
                      double level, const double *noise, uint8_t *out, double *paid);
/* `keep` for a call from outside: *paid is the price. 1 where memory is short, else 0. */
EXPORTED int keep_elements(const Choices *choices, const uint8_t *inside, const double *price, double level, uint8_t *kept, double *sums,
                           double *paid);
/* Search on for some nodes; *outcome says how that ended. `most`: partitions that are tried at a node. 1 where memory is
   short, else 0. */
EXPORTED int dive_by_covers(const Choices *choices, const Ways *ways, Covers *covers, const Sums *sums, Stack *stack, Nodes *record,
                            double level, int64_t nodes, int64_t most, int *outcome);
