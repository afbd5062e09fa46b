/* Sizes of the records that Python makes, for the tests that both sides mean the same. */
#include <string.h>

#include "covers.h"
#include "marginals.h"
#include "annealing.h"
#include "groups.h"
#include "kept_links.h"
#include "planar.h"
#include "polytopes.h"
#include "pricing.h"
#include "sets_of_size.h"
#include "sets.h"
#include "team.h"

EXPORTED void layout(int64_t *sizes) {
    sizes[0] = sizeof(Team);
    sizes[1] = sizeof(Branch);
    sizes[2] = sizeof(Level);
    sizes[3] = sizeof(Anneal);
    sizes[4] = sizeof(Pricing);
    sizes[5] = sizeof(SetQuestion);
    sizes[6] = sizeof(Choice);
    sizes[7] = sizeof(DisjointSets);
    sizes[8] = sizeof(GroupTree);
    sizes[9] = sizeof(Cover);
    sizes[10] = sizeof(KeptLinks);
    sizes[11] = sizeof(CutAnneal);
    sizes[12] = sizeof(Greedy);
    sizes[13] = sizeof(Descent);
    sizes[14] = sizeof(Columns);
    sizes[15] = sizeof(Duals);
}

/* Those of the searches for best plans. */
EXPORTED void layout_of_searches(int64_t *sizes) {
    const int64_t all[] = {sizeof(Choices), sizeof(Ways),   sizeof(Covers),   sizeof(Sums),    sizeof(Step), sizeof(Stack),
                           sizeof(Node),    sizeof(Record), sizeof(Choosers), sizeof(Attacks), sizeof(Path), sizeof(Gains)};
    memcpy(sizes, all, sizeof(all));
}
