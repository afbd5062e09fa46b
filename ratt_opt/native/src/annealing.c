/* Attacks by annealing partitions and blinded robots together. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "sets.h"
#include "team.h"

/* Bounds between the chances of a transfer, another blinded robot and two robots exchanged; the chance that a transfer
   opens a group of its own. Flat: a tenth more or less of each was not measured to matter. */
static const double TRANSFER = 0.6, BLINDING = 0.96, OWN_GROUP = 0.05;

enum { CHUNK = 8, MOST_ROBOTS = 32 };

/* Values of sets: from a table of all, or from sums over sets of CHUNK robots at a time. */
typedef struct {
    const double *table;
    const Team *team;
    double *chunks, *sums; /* (robots / CHUNK, 1 << CHUNK, width); (width) */
    int width;
} Values;

static int prepare(Values *values) {
    const Team *team = values->team;
    if (values->table) return 0;
    int width = team->targets * entries_of(team), count = (team->robots + CHUNK - 1) / CHUNK;
    values->width = width;
    values->chunks = calloc(((size_t)count << CHUNK) * width + width, sizeof(double));
    if (!values->chunks) return 1;
    values->sums = values->chunks + ((size_t)count << CHUNK) * width;
    for (int chunk = 0; chunk < count; chunk++)
        for (int set = 0; set < 1 << CHUNK; set++) {
            double *sum = values->chunks + (((size_t)chunk << CHUNK) + set) * width;
            int robot = chunk * CHUNK + (set ? lowest((uint64_t)set) : 0);
            if (set == 0) {
                if (chunk == 0) memcpy(sum, team->prior, (size_t)width * sizeof(double));
            } else if (robot < team->robots) {
                const double *rest = values->chunks + (((size_t)chunk << CHUNK) + (set & (set - 1))) * width;
                for (int t = 0; t < width; t++) sum[t] = rest[t] + team->information[(size_t)robot * width + t];
            }
        }
    return 0;
}

static double value_of_set(const Values *values, uint32_t set) {
    if (values->table) return values->table[set];
    const double *first = values->chunks + (size_t)(set & ((1 << CHUNK) - 1)) * values->width;
    memcpy(values->sums, first, (size_t)values->width * sizeof(double));
    for (int chunk = 1; set >> (chunk * CHUNK) && chunk * CHUNK < MOST_ROBOTS; chunk++) {
        size_t row = ((size_t)chunk << CHUNK) + (set >> (chunk * CHUNK) & ((1 << CHUNK) - 1));
        const double *more = values->chunks + row * values->width;
        for (int t = 0; t < values->width; t++) values->sums[t] += more[t];
    }
    return value_of(values->team, values->sums);
}

typedef struct {
    uint64_t state;
} Random;

/* Uniform in [0, 1); xorshift64*, Vigna 2016. */
static double uniform(Random *random) {
    uint64_t x = random->state;
    x ^= x >> 12, x ^= x << 25, x ^= x >> 27;
    random->state = x;
    return (double)((x * 0x2545F4914F6CDD1DULL) >> 11) * 0x1p-53;
}

static int below(Random *random, int count) { return (int)(uniform(random) * count); }

static int pick_robot(Random *random, uint32_t set) {
    for (int skip = below(random, size_of(set)); skip > 0; skip--) set &= set - 1;
    return lowest(set);
}

typedef struct {
    int robots, budget;               /* links that may be cut */
    const uint32_t *neighbours, *protected_links;
    uint32_t protected_robots;
} Threat;

typedef struct {
    uint8_t *label;                   /* (robots) group of each */
    uint32_t group[MOST_ROBOTS], blinded;
    double value[MOST_ROBOTS];        /* of each group; minus infinity where it is empty */
    int cut;
} State;

/* A move: robots i and, if exchanged, j; the groups `home` and `to` afterwards, links cut, robots blinded. */
typedef struct {
    int kind, i, j, home, to, cut;
    uint32_t of_home, of_to, blinded;
} Move;

enum { IMPOSSIBLE, MOVED, BLINDED, EXCHANGED };

static Move propose(const Threat *threat, const State *state, Random *random) {
    double chance = uniform(random);
    int i = below(random, threat->robots), j = below(random, threat->robots);
    Move move = {IMPOSSIBLE, i, j, state->label[i], state->label[j], state->cut, 0, 0, state->blinded};
    uint32_t one = (uint32_t)1 << i, other = (uint32_t)1 << j, near = threat->neighbours[i];
    uint32_t home = state->group[move.home];
    if (chance < TRANSFER || !state->blinded) {
        if (!near || uniform(random) < OWN_GROUP) {
            move.to = 0;
            while (move.to < threat->robots && state->group[move.to]) move.to++;
            if (home == one || move.to == threat->robots) return move;
        } else {
            move.to = state->label[pick_robot(random, near)];
        }
        if (move.to == move.home) return move;
        move.of_home = home & ~one, move.of_to = state->group[move.to] | one;
        move.cut += size_of(near & move.of_home) - size_of(near & state->group[move.to]);
        if (!(threat->protected_links[i] & move.of_home)) move.kind = MOVED;
    } else if (chance < BLINDING) {
        if ((state->blinded | threat->protected_robots) & other) return move;
        move.i = pick_robot(random, state->blinded);
        move.blinded = (state->blinded & ~((uint32_t)1 << move.i)) | other;
        move.to = state->label[move.i], move.home = state->label[j];
        move.of_to = state->group[move.to], move.of_home = state->group[move.home];
        move.kind = BLINDED;
    } else if (move.home != move.to) {
        uint32_t there = state->group[move.to], far = threat->neighbours[j];
        move.of_home = (home & ~one) | other, move.of_to = (there & ~other) | one;
        move.cut += size_of(near & home) - size_of(near & there) + size_of(far & there) - size_of(far & home);
        if (near & other) move.cut += 2; /* stays cut, and was counted as joined from both ends */
        if (!(threat->protected_links[i] & home) && !(threat->protected_links[j] & there)) move.kind = EXCHANGED;
    }
    if (move.cut > threat->budget) move.kind = IMPOSSIBLE;
    return move;
}

static double largest(const State *state, int robots) {
    double most = state->value[0];
    for (int g = 1; g < robots; g++) most = fmax(most, state->value[g]);
    return most;
}

static double group_value(const Values *values, uint32_t group, uint32_t blinded) {
    return group ? value_of_set(values, group & ~blinded) : -INFINITY;
}

/* Make a move if its value is at most `bound`; whether it was made. The group that gains is valued first. */
static int accept(const Values *values, State *state, const Move *move, double bound, int robots) {
    double to = group_value(values, move->of_to, move->blinded);
    if (to > bound) return 0;
    double home = move->home == move->to ? to : group_value(values, move->of_home, move->blinded);
    if (home > bound) return 0;
    double before_home = state->value[move->home], before_to = state->value[move->to];
    state->value[move->home] = home, state->value[move->to] = to;
    if (largest(state, robots) > bound) {
        state->value[move->to] = before_to, state->value[move->home] = before_home;
        return 0;
    }
    state->group[move->home] = move->of_home, state->group[move->to] = move->of_to;
    state->blinded = move->blinded, state->cut = move->cut;
    if (move->kind != BLINDED) state->label[move->i] = (uint8_t)move->to;
    if (move->kind == EXCHANGED) state->label[move->j] = (uint8_t)move->home;
    return 1;
}

/* Anneal an attack within the budgets, in place: `label` (robots) groups, `blinded`. From temperature `hot` to `cold` in
   `steps`. Where a state leaves the team less than *least, which is the value of its largest group (groups may be
   disconnected: the attack leaves no more), it is kept: *least, best_label, *best_blinded. Values are those of `table`,
   where one is given, or of `team`. 1 where memory is short, else 0. */
EXPORTED int anneal(const double *table, const Team *team, int robots, const uint32_t *neighbours, const uint32_t *protected_links,
                    uint32_t protected_robots, int budget, uint8_t *label, uint32_t *blinded, int64_t steps, double hot, double cold,
                    uint64_t *seed, double *least, uint8_t *best_label, uint32_t *best_blinded) {
    Values values = {table, team, NULL, NULL, 0};
    if (prepare(&values)) return 1;
    Threat threat = {robots, budget, neighbours, protected_links, protected_robots};
    State state = {.label = label, .blinded = *blinded};
    Random random = {*seed};
    for (int i = 0; i < robots; i++) state.group[label[i]] |= (uint32_t)1 << i;
    for (int i = 0; i < robots; i++) state.cut += size_of(neighbours[i] & ~state.group[label[i]]);
    state.cut /= 2;
    for (int g = 0; g < MOST_ROBOTS; g++) state.value[g] = group_value(&values, state.group[g], state.blinded);
    double energy = largest(&state, robots), temperature = hot, cooling = pow(cold / hot, 1.0 / (double)(steps > 1 ? steps - 1 : 1));
    for (int64_t step = 0; step <= steps; step++, temperature *= cooling) {
        if (energy < *least) {
            *least = energy, *best_blinded = state.blinded;
            memcpy(best_label, label, (size_t)robots);
        }
        if (step == steps) break;
        Move move = propose(&threat, &state, &random);
        double bound = energy - temperature * log(1.0 - uniform(&random));
        if (move.kind != IMPOSSIBLE && accept(&values, &state, &move, bound, robots)) energy = largest(&state, robots);
    }
    *blinded = state.blinded, *seed = random.state;
    free(values.chunks);
    return 0;
}
