/* Attacks by annealing partitions and blinded robots together. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "annealing.h"
#include "random.h"

/* Bounds between the chances of a transfer, another blinded robot and two robots exchanged; the chance that a transfer
   opens a group of its own. Flat: a tenth more or less of each was not measured to matter. */
static const double TRANSFER = 0.6, BLINDING = 0.96, OWN_GROUP = 0.05;

enum { UNCUTTABLE = 1000000 }; /* links that a protected link counts for */

enum { IMPOSSIBLE, MOVED, BLINDED, EXCHANGED };

/* Robot i's view is gained by the group `to`, which it joins or where it was blinded, and lost by `home`; j is the robot
   that is exchanged for it, or blinded instead. */
typedef struct {
    int kind;
    int64_t i, j, home, to;
} Move;

/* Groups by label: what is sensed in each, as sums (robots, width). */
typedef struct {
    const Anneal *a;
    int width;
    double *sums, *value, *gained, *lost;
    int64_t *size, cut;
    uint64_t random;
} State;

static int64_t below(State *s, int64_t count) { return (int64_t)(uniform(&s->random) * (double)count); }

static void fill(State *s) {
    const Anneal *a = s->a;
    for (int64_t g = 0; g < a->robots; g++) memcpy(s->sums + g * s->width, a->team->prior, (size_t)s->width * sizeof(double));
    s->cut = 0;
    for (int64_t i = 0; i < a->robots; i++) {
        int64_t g = a->group[i];
        s->size[g]++;
        if (!a->blind[i]) add_information(a->team, s->sums + g * s->width, 1.0, i, s->sums + g * s->width);
        for (int64_t l = a->start[i]; l < a->start[i + 1]; l++)
            if (a->robot[l] > i && a->group[a->robot[l]] != g) s->cut += a->fixed[l] ? UNCUTTABLE : 1;
    }
    for (int64_t g = 0; g < a->robots; g++) s->value[g] = s->size[g] ? value_of(a->team, s->sums + g * s->width) : 0.0;
}

static Move propose(State *s, int64_t n_blinded) {
    const Anneal *a = s->a;
    double chance = uniform(&s->random);
    int64_t i = below(s, a->robots), j = below(s, a->robots);
    Move move = {IMPOSSIBLE, i, j, a->group[i], a->group[j]};
    if (chance < TRANSFER || n_blinded == 0) {
        int64_t degree = a->start[i + 1] - a->start[i];
        if (degree == 0 || uniform(&s->random) < OWN_GROUP) {
            if (s->size[move.home] == 1) return move;
            for (move.to = 0; s->size[move.to];) move.to++;
        } else {
            move.to = a->group[a->robot[a->start[i] + below(s, degree)]];
        }
        move.kind = move.to != move.home ? MOVED : IMPOSSIBLE;
    } else if (chance < BLINDING) {
        while (!a->blind[move.i]) move.i = below(s, a->robots);
        move.home = a->group[j], move.to = a->group[move.i];
        move.kind = a->blind[j] || a->seeing[j] ? IMPOSSIBLE : BLINDED;
    } else if (move.home != move.to) {
        move.kind = EXCHANGED;
    }
    return move;
}

/* Links cut when a robot changes groups, less those that then are not. */
static int64_t more_links(const Anneal *a, int64_t robot, int64_t home, int64_t to) {
    int64_t more = 0;
    for (int64_t l = a->start[robot]; l < a->start[robot + 1]; l++) {
        int64_t other = a->group[a->robot[l]], weight = a->fixed[l] ? UNCUTTABLE : 1;
        more += other == home ? weight : other == to ? -weight : 0;
    }
    return more;
}

static int64_t links_after(const State *s, const Move *m) {
    const Anneal *a = s->a;
    int64_t after = s->cut;
    if (m->kind != BLINDED) after += more_links(a, m->i, m->home, m->to);
    if (m->kind == EXCHANGED) {
        after += more_links(a, m->j, m->to, m->home);
        for (int64_t l = a->start[m->i]; l < a->start[m->i + 1]; l++)
            if (a->robot[l] == m->j) after += a->fixed[l] ? 2 * UNCUTTABLE : 2; /* stays cut, and was counted as joined twice */
    }
    return after;
}

/* Robots that a group senses with and without after a move: +1 gains i, -1 loses it; 0 nothing. */
static void changes(const Anneal *a, const Move *m, int gains, int *of_i, int *of_j) {
    int sign = gains ? 1 : -1;
    *of_i = (m->kind == BLINDED ? gains : !a->blind[m->i]) ? sign : 0;
    *of_j = 0;
    if (m->kind == BLINDED && (m->home == m->to || !gains)) *of_j = -1;
    if (m->kind == EXCHANGED && !a->blind[m->j]) *of_j = -sign;
}

/* Value of the group that gains or loses by a move, of both where they are one; what is sensed goes to `sums`. */
static double value_after(State *s, const Move *m, int gains, double *sums) {
    const Anneal *a = s->a;
    int64_t g = gains ? m->to : m->home;
    int of_i, of_j;
    changes(a, m, gains, &of_i, &of_j);
    int empties = m->kind == MOVED && !gains && s->size[m->home] == 1;
    memcpy(sums, s->sums + g * s->width, (size_t)s->width * sizeof(double));
    if (of_i) add_information(a->team, sums, of_i, m->i, sums);
    if (of_j) add_information(a->team, sums, of_j, m->j, sums);
    return empties ? 0.0 : value_of(a->team, sums);
}

/* Whether no robot that senses is concerned. */
static int senses_alike(const Anneal *a, const Move *m) {
    return m->kind != BLINDED && a->blind[m->i] && (m->kind == MOVED || a->blind[m->j]);
}

/* Labels, blinded robots and links; not what is sensed. */
static void apply(State *s, const Move *m, int64_t cut) {
    const Anneal *a = s->a;
    s->cut = cut;
    if (m->kind == BLINDED) {
        a->blind[m->i] = 0, a->blind[m->j] = 1;
        return;
    }
    a->group[m->i] = m->to;
    if (m->kind == EXCHANGED) a->group[m->j] = m->home;
    else s->size[m->home]--, s->size[m->to]++;
}

static double largest(const State *s) {
    double most = s->value[0];
    for (int64_t g = 1; g < s->a->robots; g++) most = s->value[g] > most ? s->value[g] : most;
    return most;
}

/* Make a move if no group is then worth more than `bound`; the group that gains is valued first. */
static void try_move(State *s, const Move *m, int64_t cut, double bound, double *energy) {
    double more = value_after(s, m, 1, s->gained);
    if (more > bound) return;
    double less = m->home != m->to ? value_after(s, m, 0, s->lost) : more;
    if (less > bound) return;
    double home = s->value[m->home], to = s->value[m->to];
    s->value[m->home] = less, s->value[m->to] = more;
    double after = largest(s);
    if (after > bound) {
        s->value[m->home] = home, s->value[m->to] = to;
        return;
    }
    *energy = after;
    apply(s, m, cut);
    if (m->home != m->to) memcpy(s->sums + m->home * s->width, s->lost, (size_t)s->width * sizeof(double));
    memcpy(s->sums + m->to * s->width, s->gained, (size_t)s->width * sizeof(double));
}

static void keep_better(const State *s, double energy) {
    const Anneal *a = s->a;
    if (energy >= *a->least) return;
    *a->least = energy;
    memcpy(a->best_group, a->group, (size_t)a->robots * sizeof(int64_t));
    memcpy(a->best_blind, a->blind, (size_t)a->robots);
}

int anneal(const Anneal *a) {
    int64_t n = a->robots, width = (int64_t)a->team->targets * entries_of(a->team);
    double *memory = calloc((size_t)(n * width + n + 2 * width), sizeof(double));
    int64_t *counts = calloc((size_t)n, sizeof(int64_t));
    if (!memory || !counts) {
        free(memory), free(counts);
        return 1;
    }
    double *value = memory + n * width;
    State s = {a, (int)width, memory, value, value + n, value + n + width, counts, 0, *a->random};
    fill(&s);
    int64_t n_blinded = 0;
    for (int64_t i = 0; i < n; i++) n_blinded += a->blind[i];
    double energy = largest(&s);
    keep_better(&s, energy);
    for (int64_t step = a->first; step < a->last; step++) {
        Move move = propose(&s, n_blinded);
        if (move.kind == IMPOSSIBLE) continue;
        int64_t cut = links_after(&s, &move);
        if (cut > a->budget) continue;
        if (senses_alike(a, &move)) {
            apply(&s, &move, cut);
            continue;
        }
        double temperature = a->hot * pow(a->cold / a->hot, (double)step / (double)a->steps);
        try_move(&s, &move, cut, energy - temperature * log(1.0 - uniform(&s.random)), &energy);
        keep_better(&s, energy);
    }
    *a->random = s.random;
    free(memory), free(counts);
    return 0;
}
