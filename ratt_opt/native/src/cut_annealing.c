/* Few links whose cut leaves no large group, by annealing the groups of robots. */
#include <math.h>
#include <string.h>

#include "annealing.h"

static const double NEXT_TO = 0.95; /* the chance that a robot goes to the group of a neighbour; else to any */

static double uniform(const CutAnneal *a) { return a->uniform(a->random); }

static int64_t below(const CutAnneal *a, int64_t count) { return (int64_t)(uniform(a) * (double)count); }

static int64_t links_cut(const CutAnneal *a) {
    int64_t cut = 0;
    for (int64_t i = 0; i < a->robots; i++)
        for (int64_t l = a->start[i]; l < a->start[i + 1]; l++)
            if (a->group[a->robot[l]] != a->group[i]) cut += a->price[l];
    return cut / 2;
}

static int64_t over_size(const CutAnneal *a, int64_t size) { return size > a->most ? size - a->most : 0; }

static int64_t robots_too_many(const CutAnneal *a) {
    int64_t over = 0;
    for (int64_t g = 0; g < a->groups; g++) over += over_size(a, a->sizes[g]);
    return over;
}

/* Links cut when a robot changes groups, less those that then are not. */
static int64_t more_links(const CutAnneal *a, int64_t robot, int64_t home, int64_t to) {
    int64_t more = 0;
    for (int64_t l = a->start[robot]; l < a->start[robot + 1]; l++) {
        int64_t other = a->group[a->robot[l]];
        more += other == home ? a->price[l] : other == to ? -a->price[l] : 0;
    }
    return more;
}

int64_t anneal_cut(const CutAnneal *a, int64_t first, int64_t last, int64_t moves, int64_t fewest) {
    int64_t cut = links_cut(a), over = robots_too_many(a);
    for (int64_t move = first; move < last; move++) {
        int64_t i = below(a, a->robots), degree = a->start[i + 1] - a->start[i], home = a->group[i];
        int is_next = degree && uniform(a) < NEXT_TO;
        int64_t to = is_next ? a->group[a->robot[a->start[i] + below(a, degree)]] : below(a, a->groups);
        if (home == to) continue;
        int64_t more = more_links(a, i, home, to);
        int64_t excess = over_size(a, a->sizes[to] + a->counts[i]) - over_size(a, a->sizes[to]);
        excess += over_size(a, a->sizes[home] - a->counts[i]) - over_size(a, a->sizes[home]);
        double worse = (double)more + a->oversize * (double)excess;
        if (worse > 0.0) {
            double temperature = a->hot * pow(a->cold / a->hot, (double)move / (double)moves);
            if (uniform(a) >= exp(-worse / temperature)) continue;
        }
        a->group[i] = to, cut += more, over += excess;
        a->sizes[home] -= a->counts[i], a->sizes[to] += a->counts[i];
        if (over == 0 && cut < fewest) {
            fewest = cut;
            memcpy(a->best, a->group, (size_t)a->robots * sizeof(int64_t));
        }
    }
    return fewest;
}
