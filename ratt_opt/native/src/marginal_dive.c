/* The loop of a search in depth over all plans: a node is a dead end if one attack leaves too little.

   In the order of a path the first robots have chosen an element each. What the others can add to these is at most the
   sum, over robots, of an element's largest gain: log-determinants are submodular (Nemhauser, Wolsey and Fisher 1978). */
#include "marginals.h"

enum { PROVED, SPENT, PLAN, FULL }; /* how a run ends, see levels.py */
enum { BRANCHED = -1 };             /* in a record: the node is divided by the elements of the next robot */

/* Keep the gains beside a set of seers of a target in row `at`. */
static void work_out(const Choosers *team, Gains *gains, const Path *path, int64_t target, uint64_t seers, int64_t at) {
    const Elements *all = &team->all;
    int64_t depth = path->depth;
    double known[LARGEST_DIMENSION * (LARGEST_DIMENSION + 1) / 2], matrix[LARGEST_DIMENSION * (LARGEST_DIMENSION + 1) / 2];
    gains->version[at] = path->version[target], gains->seers[at] = seers, gains->since[at] = depth;
    for (int64_t t = 0; t < all->entries; t++) known[t] = all->prior[target * all->entries + t];
    for (uint64_t rest = seers; rest; rest &= rest - 1) {
        const double *own = information_of(all, path->chosen[lowest(rest)], target);
        for (int64_t t = 0; t < all->entries; t++) known[t] += own[t];
    }
    double weight = all->weights[target], before = log_determinant(all->dimension, known);
    gains->value[at] = all->baseline[target] + weight * before;
    const int64_t *seeing = team->seeing + target * all->elements;
    for (int64_t n = 0; n < all->elements && seeing[n] >= team->first[depth]; n++) {
        const double *own = information_of(all, seeing[n], target);
        for (int64_t t = 0; t < all->entries; t++) matrix[t] = known[t] + own[t];
        gains->gain[at * all->elements + seeing[n]] = weight * (log_determinant(all->dimension, matrix) - before);
    }
}

/* The row of a target's set of seers among those that are kept. */
static int64_t row_of(const Choosers *team, Gains *gains, const Path *path, int64_t target, uint64_t seers) {
    int64_t at = target * gains->sets + (int64_t)((seers * 0x9E3779B97F4A7C15ULL) >> 40) % gains->sets;
    if (gains->version[at] != path->version[target] || gains->seers[at] != seers || gains->since[at] > path->depth)
        work_out(team, gains, path, target, seers, at);
    return at;
}

/* The largest gain of a robot's elements beside the sets asked for. */
static double largest_gain(const Choosers *team, const Gains *gains, int64_t robot) {
    const Elements *all = &team->all;
    double most = 0.0;
    for (int64_t e = team->first[robot]; e < team->first[robot + 1]; e++) {
        double gain = 0.0;
        for (int64_t j = 0; j < all->targets; j++)
            if (sees(all, e, j)) gain += gains->gain[gains->slot[j] * all->elements + e];
        most = gain > most ? gain : most;
    }
    return most;
}

/* Whether what is chosen in a group, and what is gained at most, exceeds the level. */
static int is_worth_more(const Choosers *team, uint64_t members, Gains *gains, const Path *path, double level) {
    double total = 0.0;
    for (int64_t j = 0; j < team->all.targets; j++) {
        gains->slot[j] = row_of(team, gains, path, j, path->seers[j] & members);
        total += gains->value[gains->slot[j]];
    }
    for (int64_t i = path->depth; i < team->robots && !(total > level); i++)
        if (members >> i & 1) total += largest_gain(team, gains, i);
    return total > level;
}

/* Whether no group that an attack leaves is worth more than the level. */
static int is_weak(const Choosers *team, const Attacks *attacks, Gains *gains, const Path *path, int64_t attack, double level) {
    for (int64_t n = 0; n < attacks->widest; n++) {
        int64_t g = attacks->of[attack * attacks->widest + n];
        if (g >= 0 && is_worth_more(team, attacks->members[g], gains, path, level)) return 0;
    }
    return 1;
}

/* The first of some attacks that makes the node a dead end, which becomes the first to be tried; or BRANCHED. */
static int64_t dead_end(const Choosers *team, Attacks *attacks, Gains *gains, const Path *path, double level, int64_t most) {
    for (int64_t n = 0; n < attacks->attacks && n < most; n++) {
        int64_t attack = attacks->order[n];
        if (!is_weak(team, attacks, gains, path, attack, level)) continue;
        for (; n > 0; n--) attacks->order[n] = attacks->order[n - 1];
        return attacks->order[0] = attack;
    }
    return BRANCHED;
}

static void mark_seen(const Choosers *team, Path *path, int64_t robot) {
    for (int64_t j = 0; j < team->all.targets; j++)
        if (sees(&team->all, path->chosen[robot], j)) path->seers[j] ^= (uint64_t)1 << robot, path->version[j]++;
}

static void choose(const Choosers *team, Path *path, int64_t element) {
    path->chosen[path->depth] = element;
    mark_seen(team, path, path->depth++);
}

static void take_back(const Choosers *team, Path *path) { mark_seen(team, path, --path->depth); }

int dive_by_marginals(const Choosers *team, Attacks *attacks, Gains *gains, Path *path, double level, double slack, int64_t nodes,
                      int64_t most) {
    while (nodes-- > 0) {
        int is_plan = path->depth == team->robots;
        int64_t ended = dead_end(team, attacks, gains, path, is_plan ? level + slack : level, is_plan ? attacks->attacks : most);
        if (ended == BRANCHED && is_plan) return PLAN;
        path->record[path->size++] = (int32_t)ended;
        if (ended == BRANCHED) {
            choose(team, path, team->first[path->depth]);
            continue;
        }
        while (path->depth > 0 && path->chosen[path->depth - 1] + 1 == team->first[path->depth]) take_back(team, path);
        if (path->depth == 0) return PROVED;
        take_back(team, path);
        choose(team, path, path->chosen[path->depth] + 1);
    }
    return SPENT;
}
