/* render/heat/view_memory.c: a table of views by the SHA-256 of what they follow from. */
#include "render/heat/view_memory.h"

#include "pitviper_sha256.h"

#include <stdlib.h>

enum { slots = 1 << 14, most_octets = 8 << 20 };

typedef struct Entry {
    char   key[sha256_text_size]; /* empty: none */
    bool  *known;                 /* [patches], then its records */
    size_t patches;
} Entry;

struct ViewMemory {
    size_t octets; /* of all entries */
    int    count;
    Entry  entry[slots];
};

ViewMemory *view_memory_create(void) { return calloc(1, sizeof(ViewMemory)); }

void view_memory_destroy(ViewMemory *m)
{
    if (!m) return;
    for (int k = 0; k < slots; k++) free(m->entry[k].known);
    free(m);
}

/* Which meshes, by their places in memory: they live as long as their tracer, and so as the world. */
static bool add_posed(Sha256 *digest, const PosedEntity *e)
{
    const int whole[] = {e->damage, e->model, e->node_count};
    bool good = sha256_add(digest, whole, sizeof whole) && sha256_add(digest, e->centre_enu, sizeof e->centre_enu) &&
                sha256_add(digest, &e->radius_m, sizeof e->radius_m) && sha256_add(digest, e->p_enu, sizeof e->p_enu) &&
                sha256_add(digest, e->r_enu_from_body, sizeof e->r_enu_from_body) &&
                sha256_add(digest, e->box_low, sizeof e->box_low) &&
                sha256_add(digest, e->box_high, sizeof e->box_high);
    for (int n = 0; n < e->node_count && good; n++) {
        const PosedNode *node = &e->node[n];
        good = sha256_add(digest, &node->mesh, sizeof node->mesh) &&
               sha256_add(digest, node->p_enu, sizeof node->p_enu) &&
               sha256_add(digest, node->r_enu_from_node, sizeof node->r_enu_from_node) &&
               sha256_add(digest, node->centre_enu, sizeof node->centre_enu);
    }
    return good;
}

static bool make_key(char key[sha256_text_size], const PatchPose *pose, const PosedEntity *const *other, int others,
                     const double *toward, size_t octets)
{
    Sha256        *digest = sha256_begin();
    const uint64_t head[] = {octets, (uint64_t)others, toward != NULL};
    if (!digest) return false;
    bool good = sha256_add(digest, head, sizeof head) &&
                sha256_add(digest, pose->r_enu_from_body, sizeof pose->r_enu_from_body) &&
                sha256_add(digest, &pose->above_m, sizeof pose->above_m) &&
                sha256_add(digest, pose->node, (size_t)pose->model->node_count * sizeof *pose->node) &&
                add_posed(digest, pose->posed) && (!toward || sha256_add(digest, toward, 3 * sizeof *toward));
    for (int k = 0; k < others && good; k++) {
        const bool there = other[k];
        good = sha256_add(digest, &there, sizeof there) && (!there || add_posed(digest, other[k]));
    }
    return sha256_end(key, digest, good) == STATUS_OK;
}

KnownViews view_memory_of(ViewMemory *m, const PatchPose *pose, const PosedEntity *const *other, int others,
                          const double *toward, size_t octets)
{
    const size_t patches = (size_t)pose->patches->count, size = patches * (1 + octets);
    char         key[sha256_text_size], head[9];
    if (!m || !make_key(key, pose, other, others, toward, octets)) return (KnownViews){NULL, NULL};
    memcpy(head, key, 8), head[8] = 0;
    for (unsigned k = (unsigned)strtoul(head, NULL, 16);; k++) {
        Entry *e = &m->entry[k % slots];
        if (e->known && strcmp(e->key, key) == 0 && e->patches == patches)
            return (KnownViews){e->known, (char *)(e->known + patches)};
        if (e->known) continue;
        if (m->count >= slots / 2 || m->octets + size > most_octets) return (KnownViews){NULL, NULL};
        e->known = calloc(1, size + 1);
        if (!e->known) return (KnownViews){NULL, NULL};
        memcpy(e->key, key, sizeof key);
        e->patches = patches;
        m->octets += size, m->count++;
        return (KnownViews){e->known, (char *)(e->known + patches)};
    }
}
