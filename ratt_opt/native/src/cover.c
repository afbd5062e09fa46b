/* Exact covers of the team by groups, within the budgets and a sum of reduced costs. */
#include "records.h"
#include "sets.h"

enum { FOUND = 1, NONE = 0, PAUSED = -1, NO_ROOM = -2 };

/* The robot with the fewest columns. */
static int rarest(const Level *level, const int32_t *fitting, const uint32_t *groups) {
    int64_t counts[32] = {0};
    int pick = -1;
    for (int64_t k = level->start; k < level->end; k++)
        for (uint32_t rest = groups[fitting[k]]; rest;) counts[next_robot(&rest)]++;
    for (uint32_t rest = level->left; rest;) {
        int i = next_robot(&rest);
        if (pick < 0 || counts[i] < counts[pick]) pick = i;
    }
    return pick;
}

/* Go on from levels[depth] to the next cover. Columns are sorted by reduced cost. `fitting` (room) holds those that fit at
   each level, one after the other. `depth`: -1 at the end; `nodes`: counted; `steps`: columns looked at before a pause. */
EXPORTED int next_cover(const uint32_t *groups, const uint8_t *cuts, const uint8_t *blinded, const int64_t *costs,
                        int32_t *fitting, int64_t room, Level *levels, int64_t *depth, int64_t *nodes, int64_t steps) {
    while (*depth >= 0) {
        Level *level = levels + *depth;
        if (steps <= 0) return PAUSED;
        if (level->robot < 0) {
            ++*nodes;
            steps -= level->end - level->start;
            level->robot = rarest(level, fitting, groups);
            level->position = level->start;
        }
        uint32_t bit = (uint32_t)1 << level->robot;
        int64_t at = level->position;
        while (at < level->end && !(groups[fitting[at]] & bit)) at++;
        if (at >= level->end) {
            --*depth;
            continue;
        }
        int32_t column = fitting[at];
        int64_t gap = level->gap - costs[column];
        int32_t blind = level->blinded - blinded[column], cut = level->cut - cuts[column];
        uint32_t left = level->left & ~groups[column], reached = 0;
        level->position = at + 1;
        level->column = column;
        if (gap < 0 || blind < 0 || cut < 0) continue;
        if (!left) return FOUND;
        if (level->end + (level->end - level->start) > room) return NO_ROOM;
        Level *next = level + 1;
        *next = (Level){gap, level->end, level->end, 0, left, -1, blind, cut, -1, 0};
        int64_t k = level->start;
        for (; k < level->end; k++) {
            int32_t other = fitting[k];
            if (costs[other] > gap) break;
            if (groups[other] & ~left || blinded[other] > blind || cuts[other] > cut) continue;
            fitting[next->end++] = other;
            reached |= groups[other];
        }
        steps -= k - level->start;
        if (reached == left) ++*depth;
    }
    return NONE;
}
