/* Sizes of the records that Python makes, for the test that both sides mean the same. */
#include "records.h"
#include "team.h"
#include "sets.h"

EXPORTED void layout(int64_t *sizes) {
    sizes[0] = sizeof(Team);
    sizes[1] = sizeof(Branch);
    sizes[2] = sizeof(Level);
    sizes[3] = sizeof(LowSets);
    sizes[4] = sizeof(Anneal);
}
