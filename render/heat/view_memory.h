/* render/heat/view_memory.h: what patches see, remembered by all that it follows from: sessions of one world, as the
 * variants of a sweep, pose the same entities alike. Whether it is remembered decides no bit, and no work of an
 * account. */
#ifndef RENDER_HEAT_VIEW_MEMORY_H
#define RENDER_HEAT_VIEW_MEMORY_H

#include "render/heat/vehicle_load_private.h"

typedef struct ViewMemory ViewMemory;

/* Remembers some 8 MB, then nothing more. One thread at a time. */
ViewMemory *view_memory_create(void);                /* NULL: no memory */
void        view_memory_destroy(ViewMemory *memory); /* accepts NULL */

/* What is known of a pose: a record for each patch. */
typedef struct KnownViews {
    bool *known;  /* [patches]; NULL: it cannot be remembered */
    char *record; /* [patches][octets] */
} KnownViews;

/* Of a pose, and of others and a direction where they count: as given to vehicle_view_look, _near and _sun. other[k]
 * may be NULL; toward: 3 numbers, or NULL. memory NULL: nothing is known. Valid until the next call. */
KnownViews view_memory_of(ViewMemory *memory, const PatchPose *pose, const PosedEntity *const *other, int others,
                          const double *toward, size_t octets);

#endif
