/* The loop of a search in depth over all plans: covers as conditions that forbid elements, then frames that each fix one.

   If a cover asks for as many robots as can still meet it, each of them must choose among what the cover leaves out; sums
   of covers forbid likewise. Masks of elements, one a robot, say what a step depends on: elements that were forbidden
   before. A dead end that does not depend on what a frame fixed is one of the frame before, too. So both are left at
   once, and the frames and steps on which nothing depends do not enter the proof (conflict-directed backjumping,
   Prosser 1993). An element that was fixed in a frame is forbidden once that frame was a dead end. */
#include <stdlib.h>
#include <string.h>

#include "covers.h"

enum { PROVED, SPENT, PLAN, FULL }; /* how a run ends, see levels.py */
enum { RECENT = 100 };              /* covers by which elements are chosen */

/* What plans have to lack of a sum at least: its weights have errors of 1e-9. */
static const double LACKING = 1e-6;

static uint64_t bit(int64_t place) { return (uint64_t)1 << place; }

/* The most that plans count in a cover. */
static double most_counted(const Choices *choices, const uint64_t *allowed, const uint64_t *left_out) {
    double total = 0.0;
    for (int64_t i = 0; i < choices->robots; i++)
        if (allowed[i] & left_out[i]) total += choices->count[i];
    return total;
}

/* The largest term of a robot's elements, of a mask; -1 without any. */
static double most_of(const Choices *choices, const double *terms, int64_t robot, uint64_t mask) {
    double most = -1.0;
    for (; mask; mask &= mask - 1) {
        double term = terms[choices->element[robot * choices->widest + lowest(mask)]];
        most = term > most ? term : most;
    }
    return most;
}

/* Those of a robot's elements whose terms are larger. */
static uint64_t above(const Choices *choices, const double *terms, int64_t robot, uint64_t mask, double most) {
    uint64_t found = 0;
    for (; mask; mask &= mask - 1)
        if (terms[choices->element[robot * choices->widest + lowest(mask)]] > most) found |= mask & -mask;
    return found;
}

/* Depend on nothing of the robots whose elements were forbidden last, as far as a condition may count so much more;
   `more` (robots): how much more each of them would count. */
static void spare_latest(const Stack *stack, int64_t robots, const double *more, double spare, uint64_t *out) {
    const int64_t *touched = stack->touched + stack->frame * robots;
    while (1) {
        int64_t latest = -1;
        for (int64_t i = 0; i < robots; i++)
            if (out[i] && more[i] <= spare && (latest < 0 || touched[i] > touched[latest])) latest = i;
        if (latest < 0) return;
        out[latest] = 0;
        spare -= more[latest];
    }
}

/* Elements that have to be forbidden for a cover to count no more: of all robots that it does not count, but one.
   `spare`: how much more it may count. */
static void cover_depends_on(const Choices *choices, const Stack *stack, const uint64_t *left_out, double spare, int64_t but,
                             uint64_t *out) {
    int64_t robots = choices->robots;
    const uint64_t *allowed = stack->allowed + stack->frame * robots;
    for (int64_t i = 0; i < robots; i++) out[i] = (allowed[i] & left_out[i]) || i == but ? 0 : left_out[i] & stack->start[i];
    spare_latest(stack, robots, choices->count, spare, out);
}

/* The same of a sum. */
static void sum_depends_on(const Choices *choices, const Stack *stack, const double *terms, double spare, int64_t but, double *more,
                           uint64_t *out) {
    int64_t robots = choices->robots;
    const uint64_t *allowed = stack->allowed + stack->frame * robots;
    for (int64_t i = 0; i < robots; i++) {
        out[i] = 0, more[i] = 0.0;
        if (i == but) continue;
        double most = most_of(choices, terms, i, allowed[i]);
        out[i] = above(choices, terms, i, stack->start[i] & ~allowed[i], most);
        more[i] = most_of(choices, terms, i, stack->start[i]) - most;
    }
    spare_latest(stack, robots, more, spare, out);
}

/* Take elements from what a robot may choose in the present frame. */
static void forbid(const Choices *choices, Stack *stack, int64_t robot, uint64_t gone) {
    int64_t row = stack->frame * choices->robots + robot;
    stack->allowed[row] &= ~gone;
    stack->touched[row] = stack->frame;
    bound_robot(choices, robot, stack->allowed[row], stack->strongest + row * width_of(&choices->all));
    for (; gone; gone &= gone - 1) stack->since[choices->element[robot * choices->widest + lowest(gone)]] = stack->frame;
}

/* Forbid elements of a robot; the caller has written the reason. */
static void step(const Choices *choices, Stack *stack, int64_t kind, int64_t what, int64_t robot, uint64_t gone) {
    stack->steps[stack->count++] = (Step){kind, what, robot, gone};
    forbid(choices, stack, robot, gone);
}

static uint64_t *next_reason(const Choices *choices, const Stack *stack) { return stack->reasons + stack->count * choices->robots; }

/* Forbid what covers forbid: how many times; or -1 - the number of one that no plan of the frame meets. */
static int64_t ask_covers(const Choices *choices, const Covers *covers, Stack *stack, double level) {
    int64_t robots = choices->robots, steps = 0;
    double enough = choices->enough;
    const uint64_t *allowed = stack->allowed + stack->frame * robots;
    for (int64_t k = 0; k < covers->size; k++) {
        const uint64_t *left_out = covers->left_out + k * robots;
        if (covers->level[k] > level) continue;
        double counted = most_counted(choices, allowed, left_out);
        if (counted < enough) return -1 - k;
        if (counted >= enough + enough) continue;
        for (int64_t i = 0; i < robots; i++) {
            uint64_t hit = allowed[i] & left_out[i];
            if (!hit || hit == allowed[i] || counted - choices->count[i] >= enough) continue;
            double spare = enough - 1.0 - (counted - choices->count[i]);
            cover_depends_on(choices, stack, left_out, spare, i, next_reason(choices, stack));
            step(choices, stack, BY_COVER, k, i, allowed[i] & ~hit);
            steps++;
        }
    }
    return steps;
}

/* The same by sums of covers. */
static int64_t ask_sums(const Choices *choices, const Sums *sums, Stack *stack, Scratch *scratch) {
    int64_t robots = choices->robots, steps = 0;
    double enough = choices->enough - LACKING, *most = scratch->most;
    const uint64_t *allowed = stack->allowed + stack->frame * robots;
    for (int64_t n = 0; n < sums->looked_at; n++) {
        int64_t r = sums->tried[n];
        const double *terms = sums->terms + r * choices->all.elements;
        double total = 0.0;
        for (int64_t i = 0; i < robots; i++) {
            most[i] = most_of(choices, terms, i, allowed[i]);
            total += most[i];
        }
        if (total < enough) {
            sums->used[r] += 1;
            return -1 - r;
        }
        for (int64_t i = 0; i < robots; i++) {
            double least = enough - (total - most[i]);
            if (!(least > 0.0)) continue;
            uint64_t gone = allowed[i] & ~above(choices, terms, i, allowed[i], least);
            double reached = total - most[i] + most_of(choices, terms, i, gone);
            if (!gone || reached >= enough) continue;
            sum_depends_on(choices, stack, terms, enough - reached, i, scratch->rises, next_reason(choices, stack));
            step(choices, stack, BY_SUM, r, i, gone);
            sums->used[r] += 1;
            steps++;
        }
    }
    return steps;
}

static int64_t write_node(Nodes *record, Node node) {
    record->nodes[record->size] = node;
    return record->size++;
}

/* The element of a step's that counts most in its sum, by its place. */
static int64_t highest(const Choices *choices, const Sums *sums, const Step *made) {
    const double *terms = sums->terms + made->what * choices->all.elements;
    int64_t best = 0;
    double most = -1.0;
    for (uint64_t mask = made->gone; mask; mask &= mask - 1) {
        double term = terms[choices->element[made->robot * choices->widest + lowest(mask)]];
        if (term > most) best = lowest(mask), most = term;
    }
    return best;
}

/* Take back the steps of a frame, and write those on which the dead end depends before node `proof`; the first node. */
static int64_t take_back(const Choices *choices, const Sums *sums, Stack *stack, Nodes *record, int64_t frame, int64_t proof,
                         uint64_t *conflict) {
    while (stack->count > stack->first[frame]) {
        const Step *made = stack->steps + --stack->count;
        if (!(conflict[made->robot] & made->gone)) continue;
        conflict[made->robot] &= ~made->gone;
        for (int64_t i = 0; i < choices->robots; i++) conflict[i] |= next_reason(choices, stack)[i];
        int64_t place = made->kind == BY_SUM ? highest(choices, sums, made) : lowest(made->gone);
        proof = write_node(record, (Node){made->kind, made->what, made->robot, place, proof});
    }
    return proof;
}

/* Set the elements on which a dead end of the present frame depends, by a cover or a sum. */
static void find_conflict(const Choices *choices, const Covers *covers, const Sums *sums, const Stack *stack, int64_t kind, int64_t what,
                          Scratch *scratch) {
    int64_t robots = choices->robots;
    const uint64_t *allowed = stack->allowed + stack->frame * robots;
    if (kind == BY_COVER) {
        const uint64_t *left_out = covers->left_out + what * robots;
        double spare = choices->enough - 1.0 - most_counted(choices, allowed, left_out);
        cover_depends_on(choices, stack, left_out, spare, robots, scratch->conflict);
        return;
    }
    const double *terms = sums->terms + what * choices->all.elements;
    double spare = choices->enough - LACKING;
    for (int64_t i = 0; i < robots; i++) spare -= most_of(choices, terms, i, allowed[i]);
    sum_depends_on(choices, stack, terms, spare, robots, scratch->rises, scratch->conflict);
}

/* Leave a dead end, and the frames before it that are dead ends for the same reason; whether all are. */
static int leave(const Choices *choices, const Covers *covers, const Sums *sums, Stack *stack, Nodes *record, int64_t kind, int64_t what,
                 Scratch *scratch) {
    int64_t robots = choices->robots, frame = stack->frame;
    uint64_t *conflict = scratch->conflict;
    find_conflict(choices, covers, sums, stack, kind, what, scratch);
    for (int64_t i = 0; i < robots; i++)
        if (conflict[i]) stack->activity[i] += 1.0;
    int64_t proof = write_node(record, (Node){kind, what, -1, 0, -1});
    while (1) {
        proof = take_back(choices, sums, stack, record, frame, proof, conflict);
        if (frame == 0) return 1;
        int64_t e = stack->fixed[frame--], i = choices->owner[e];
        uint64_t own = bit(choices->place[e]), others = stack->allowed[frame * robots + i] & ~own;
        if (!(conflict[i] & others)) continue;
        conflict[i] &= ~others;
        memcpy(next_reason(choices, stack), conflict, (size_t)robots * sizeof(uint64_t));
        stack->frame = frame;
        step(choices, stack, TRIED, proof, i, own);
        return 0;
    }
}

/* The element of a robot that most of the latest covers leave out, by its place. */
static int64_t most_left_out(const Choices *choices, const Covers *covers, int64_t robot, uint64_t allowed) {
    int64_t best = -1, asked = -1;
    for (; allowed; allowed &= allowed - 1) {
        int64_t place = lowest(allowed), count = 0;
        for (int64_t k = covers->size > RECENT ? covers->size - RECENT : 0; k < covers->size; k++)
            count += (int64_t)(covers->left_out[k * choices->robots + robot] >> place & 1);
        if (count > asked) best = place, asked = count;
    }
    return best;
}

/* Fix an element of the robot that took part in most dead ends for each of its elements; whether one was left. */
static int fix(const Choices *choices, const Covers *covers, Stack *stack) {
    int64_t robots = choices->robots, row = stack->frame * robots, robot = -1, width = robots * width_of(&choices->all);
    double most = -1.0;
    for (int64_t i = 0; i < robots; i++) {
        int count = size_of(stack->allowed[row + i]);
        double share = (stack->activity[i] + 1.0) / count;
        if (count > 1 && share > most) robot = i, most = share;
    }
    if (robot < 0) return 0;
    uint64_t allowed = stack->allowed[row + robot];
    int64_t best = most_left_out(choices, covers, robot, allowed), frame = ++stack->frame;
    stack->fixed[frame] = choices->element[robot * choices->widest + best];
    stack->first[frame] = stack->count;
    memcpy(stack->allowed + row + robots, stack->allowed + row, (size_t)robots * sizeof(uint64_t));
    memcpy(stack->touched + row + robots, stack->touched + row, (size_t)robots * sizeof(int64_t));
    memcpy(stack->strongest + frame * width, stack->strongest + (frame - 1) * width, (size_t)width * sizeof(double));
    forbid(choices, stack, robot, allowed & ~bit(best));
    return 1;
}

int dive_by_covers(const Choices *choices, const Ways *ways, Covers *covers, const Sums *sums, Stack *stack, Nodes *record, double level,
                   int64_t nodes, int64_t most, int *outcome) {
    Scratch scratch;
    if (prepare_scratch(&scratch, choices, ways->groups)) return 1;
    *outcome = SPENT;
    while (nodes-- > 0 && *outcome == SPENT) {
        if (covers->size == covers->room || record->size + choices->all.elements + 1 >= record->room) {
            *outcome = FULL;
            break;
        }
        int64_t kind = BY_COVER, found = 1;
        while (found > 0) {
            found = ask_covers(choices, covers, stack, level), kind = BY_COVER;
            if (found == 0) found = ask_sums(choices, sums, stack, &scratch), kind = BY_SUM;
        }
        int64_t what = -1 - found;
        if (found == 0) what = new_cover(choices, ways, covers, stack, level, most, &scratch), kind = BY_COVER;
        if (what >= 0) {
            if (leave(choices, covers, sums, stack, record, kind, what, &scratch)) *outcome = PROVED;
        } else if (!fix(choices, covers, stack)) {
            *outcome = PLAN;
        }
    }
    free(scratch.memory);
    return 0;
}
