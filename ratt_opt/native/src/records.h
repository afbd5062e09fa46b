/* Records that Python makes and C reads and writes. */
#ifndef RATT_RECORDS_H
#define RATT_RECORDS_H

#include <stdint.h>

/* A node of the list of groups: robots inside, robots outside, links between them. */
typedef struct {
    uint32_t inside, outside;
    int32_t cut;
} Branch;

/* A level of the search of covers. */
typedef struct {
    int64_t gap;                       /* reduced cost that is left */
    int64_t start, end, position;      /* of the columns that fit, in `fitting` */
    uint32_t left;                     /* robots not covered */
    int32_t robot, blinded, cut;       /* the robot that is covered next, -1 until chosen; budgets left */
    int32_t column, unused;            /* the column tried */
} Level;

/* Integer duals, in units of a link: `low`, `high` sums over sets of the first HALF robots and of the others, `unit` of
   a link, `blinding` of a blinded robot. */
typedef struct {
    const int64_t *low, *high;
    int64_t unit, blinding;
} Duals;

#endif
