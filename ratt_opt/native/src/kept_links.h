/* Groups with more link weight inside than their robots' prices. */
#pragma once
#include "sets.h"

/* Groups with more link weight inside than their robots' prices. */
typedef struct {
    int64_t robots, links;
    const int64_t *ends;               /* (links, 2) */
    const int64_t *start, *arc;        /* (robots + 1) of each robot's links in `arc` (2 links) */
    const int64_t *weight;             /* (links) in units of prices */
    const int64_t *price, *size;       /* (robots) */
    int64_t room, threshold, listing;  /* sizes and values of groups that are found; listing: all of them, each once */
    int64_t most_found, found;
    uint8_t *groups;                   /* (most_found, robots) */
    int64_t *values;                   /* (most_found) */
    int64_t most_length, length;       /* of `tree`, the proof that there is no such group; 0: none is written */
    int64_t *tree;
    int64_t nodes;
} KeptLinks;

/* An open search of kept links. */
typedef struct KeptSearch KeptSearch;

EXPORTED void close_kept_links(KeptSearch *s);
/* Begin a search, whose arrays are kept alive by others; NULL if memory is short. */
EXPORTED KeptSearch *open_kept_links(KeptLinks *question);
/* Go on for `nodes` nodes. PAUSED: they are used up; FULL: groups must be taken away first. */
EXPORTED int search_kept_links(KeptSearch *s, int64_t nodes);
