/* A group of small reduced cost, by annealing around one robot. Nothing is proved here: the groups are real. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pricing.h"
#include "random.h"

enum { OUT, SENSING, BLIND };
static const double ALONG = 0.6, SWAP = 0.4; /* chances that a move goes along a link, and that another robot changes too */
static const double JOIN_SENSING = 0.6, TO_BLIND = 0.3, TO_SENSING = 0.4; /* of what a robot becomes */
static const int64_t NEVER = (int64_t)1 << 50;

typedef struct {
    const Pricing *q;
    int n, width;
    int8_t *part;
    double *sums, *trial;
    uint64_t random;
} Group;

typedef struct {
    int robot, becomes, other, other_becomes; /* other: -1 for none */
} Move;

/* Make a robot something else; what the reduced cost rises by. */
static int64_t change(Group *g, int robot, int becomes) {
    const Pricing *q = g->q;
    int was = g->part[robot];
    int64_t rise = q->blinding * ((becomes == BLIND) - (was == BLIND));
    if ((becomes == OUT) != (was == OUT)) {
        int64_t joining = -q->duals[robot];
        for (int64_t a = q->start[robot]; a < q->start[robot + 1]; a++) {
            int64_t cut = q->fixed[a] ? NEVER / 1024 : q->unit;
            joining += g->part[q->robot[a]] != OUT ? -cut : cut;
        }
        rise += was == OUT ? joining : -joining;
    }
    g->part[robot] = (int8_t)becomes;
    return rise;
}

static int touches(const Group *g, int robot) {
    for (int64_t a = g->q->start[robot]; a < g->q->start[robot + 1]; a++)
        if (g->part[g->q->robot[a]] != OUT) return 1;
    return 0;
}

/* 0 where there is no such move. */
static int propose(Group *g, int first, Move *move) {
    const Pricing *q = g->q;
    int i = (int)(uniform(&g->random) * g->n);
    int64_t degree = q->start[i + 1] - q->start[i];
    if (g->part[i] != OUT && degree && uniform(&g->random) < ALONG)
        i = (int)q->robot[q->start[i] + (int64_t)(uniform(&g->random) * (double)degree)];
    double chance = uniform(&g->random);
    *move = (Move){i, OUT, -1, OUT};
    if (g->part[i] == OUT) {
        if (!touches(g, i)) return 0;
        move->becomes = chance < JOIN_SENSING ? SENSING : BLIND;
    } else if (g->part[i] == SENSING) {
        move->becomes = i == first || chance < TO_BLIND ? BLIND : OUT;
    } else {
        move->becomes = i == first || chance < TO_SENSING ? SENSING : OUT;
    }
    int j = (int)(uniform(&g->random) * g->n);
    if (j != i && j != first && g->part[j] != OUT && uniform(&g->random) < SWAP) {
        move->other = j;
        if (uniform(&g->random) < 0.5) move->other_becomes = g->part[j] == SENSING ? BLIND : SENSING;
    }
    return !(move->becomes == BLIND && q->seeing[i]) && !(move->other_becomes == BLIND && q->seeing[j]);
}

/* Whether the group stays below the threshold; its information is brought up to date if so. */
static int stays_below(Group *g, const Move *move, int was, int other_was) {
    int gain = (move->becomes == SENSING) - (was == SENSING);
    int other = move->other < 0 ? 0 : (move->other_becomes == SENSING) - (other_was == SENSING);
    memcpy(g->trial, g->sums, (size_t)g->width * sizeof(double));
    if (gain) add_information(g->q->team, g->trial, gain, move->robot, g->trial);
    if (other) add_information(g->q->team, g->trial, other, move->other, g->trial);
    if ((gain > 0 || other > 0) && !(value_of(g->q->team, g->trial) < g->q->threshold)) return 0;
    memcpy(g->sums, g->trial, (size_t)g->width * sizeof(double));
    return 1;
}

int64_t anneal_column(const Pricing *q, int64_t first, int64_t moves, double hot, double cold, uint64_t *random, int8_t *best) {
    int n = q->team->robots, width = q->team->targets * entries_of(q->team), blinded = 0;
    double *sums = malloc(2 * (size_t)width * sizeof(double));
    int8_t *part = calloc((size_t)n, 1);
    int64_t least = NEVER, cost = 0;
    if (!sums || !part) goto end;
    Group g = {q, n, width, part, sums, sums + width, *random};
    memcpy(sums, q->team->prior, (size_t)width * sizeof(double));
    add_information(q->team, sums, 1.0, first, sums);
    int senses = value_of(q->team, sums) < q->threshold;
    if (!senses && (q->n_blinded == 0 || q->seeing[first])) goto end;
    if (!senses) memcpy(sums, q->team->prior, (size_t)width * sizeof(double));
    least = cost = change(&g, (int)first, senses ? SENSING : BLIND), blinded = !senses;
    memcpy(best, part, (size_t)n);
    for (int64_t step = 0; step < moves; step++) {
        Move move;
        if (!propose(&g, (int)first, &move)) continue;
        int was = part[move.robot], other_was = move.other < 0 ? OUT : part[move.other];
        int after = blinded + (move.becomes == BLIND) - (was == BLIND);
        if (move.other >= 0) after += (move.other_becomes == BLIND) - (other_was == BLIND);
        if (after > q->n_blinded) continue;
        double temperature = hot * pow(cold / hot, (double)step / (double)moves);
        int64_t rise = change(&g, move.robot, move.becomes);
        if (move.other >= 0) rise += change(&g, move.other, move.other_becomes);
        int taken = rise <= 0 || uniform(&g.random) < exp(-(double)rise / temperature);
        if (taken && stays_below(&g, &move, was, other_was)) {
            cost += rise, blinded = after;
            if (cost < least) {
                least = cost;
                memcpy(best, part, (size_t)n);
            }
            continue;
        }
        if (move.other >= 0) part[move.other] = (int8_t)other_was;
        part[move.robot] = (int8_t)was;
    }
    *random = g.random;
end:
    free(sums), free(part);
    return least;
}
