/* entities/import/import_names.c: suggests names of a file's nodes for patterns without a match or with too many. */
#include "entities/import/model_import_private.h"

#include <stdlib.h>
#include <strings.h>

/* Whether a name is one that readers give to a node without a name: glTF's, or another. */
static bool is_unnamed(const char *name)
{
    const size_t length = strlen(name);
    return length == 0 || (strncmp(name, "nodes[", 6) == 0 && name[length - 1] == ']');
}

static int times_named(const ImportScene *scene, const char *name)
{
    int count = 0;
    for (int i = 0; i < scene->node_count; i++) count += strcmp(scene->node[i].name, name) == 0;
    return count;
}

/* The node with the name most similar to the words of a pattern, ignoring case; -1: none has them. */
static int nearest(const ImportScene *scene, const char *pattern)
{
    char   word[model_name_size];
    size_t n = 0;
    for (const char *c = strrchr(pattern, '/') ? strrchr(pattern, '/') + 1 : pattern; *c && n + 1 < sizeof word; c++)
        if (*c != '*' && *c != '?') word[n++] = *c;
    word[n] = 0;
    for (int i = 0; n > 0 && i < scene->node_count; i++) {
        const char *name = scene->node[i].name;
        if (*name && (strcasestr(name, word) || strcasestr(word, name))) return i;
    }
    return -1;
}

void import_report_missing_node(const ImportScene *scene, const ImportPlace *place, const Sidecar *sidecar, int joint)
{
    enum { most_listed = 16 };
    const SidecarJoint *spec = &sidecar->joint[joint];
    const char         *pattern = spec->pattern[0];
    char                list[700] = "", safe[3 * model_name_size];
    size_t              n = 0;
    int                 listed = 0, unnamed = 0;
    for (int i = 0; i < scene->node_count; i++)
        for (int p = 0; p < spec->pattern_count; p++)
            if (import_matches(spec->pattern[p], scene->node[i].name) ||
                import_matches(spec->pattern[p], place[i].path)) {
                log_error(
                    "sidecar: %s:%d: joints: nodes: a later joint, or drop, has all nodes of '%s': say the general "
                    "first, then the exceptions",
                    sidecar->path, spec->line, spec->pattern[p]);
                return;
            }
    for (int i = 0; i < scene->node_count; i++) {
        const char *name = scene->node[i].name;
        bool        before = false;
        unnamed += is_unnamed(name);
        for (int k = 0; k < i && !before; k++) before = strcmp(scene->node[k].name, name) == 0;
        if (!*name || before || listed++ >= most_listed || n >= sizeof list - 120) continue;
        text_escape(safe, 96, name, strlen(name));
        n += (size_t)snprintf(list + n, sizeof list - n, "%s%s", n ? ", " : "", safe);
        if (times_named(scene, name) > 1)
            n += (size_t)snprintf(list + n, sizeof list - n, " (%d times)", times_named(scene, name));
    }
    const int near = nearest(scene, pattern);
    if (near >= 0) text_escape(safe, sizeof safe, scene->node[near].name, strlen(scene->node[near].name));
    log_error("sidecar: %s:%d: joints: no node of the file matches '%s' (case counts, * is any text)%s%s%s; of its "
              "%d nodes %d have no name; there are: %s%s",
              sidecar->path, spec->line, pattern, near >= 0 ? "; did you mean '" : "", near >= 0 ? safe : "",
              near >= 0 ? "'?" : "", scene->node_count, unnamed, list, listed > most_listed ? " ..." : "");
}

static bool is_above(const ImportScene *scene, int node, int other)
{
    for (int n = scene->node[other].parent; n >= 0; n = scene->node[n].parent)
        if (n == node) return true;
    return false;
}

/* A name without a star that several nodes have, none of them carried by another: they would move about one pivot. */
static void warn_duplicate(const ImportScene *scene, const Sidecar *sidecar, const SidecarJoint *spec,
                           const char *pattern, const ImportPlace *place)
{
    int first = -1, count = 0;
    for (int i = 0; i < scene->node_count; i++) {
        if (strcmp(scene->node[i].name, pattern) != 0 || (first >= 0 && is_above(scene, first, i))) continue;
        if (first < 0) first = i;
        count++;
    }
    if (count < 2) return;
    log_warn(
        "sidecar: %s:%d: joints: nodes: %d nodes of the file have the name '%s' and will move as one; `each: true` "
        "makes a joint of each, a path such as '%s' takes one, or rename them in the file",
        sidecar->path, spec->line, count, pattern, place[first].path);
}

void import_warn_names(const ImportScene *scene, const ImportPlace *place, const Sidecar *sidecar, const char *file)
{
    int unnamed = 0, meshes = 0;
    for (int j = 0; j < sidecar->joint_count; j++)
        for (int p = 0; p < sidecar->joint[j].pattern_count && !sidecar->joint[j].each; p++)
            if (!strpbrk(sidecar->joint[j].pattern[p], "*?"))
                warn_duplicate(scene, sidecar, &sidecar->joint[j], sidecar->joint[j].pattern[p], place);
    const bool by_name = sidecar->joint_count || sidecar->roles.count || sidecar->thickness.count ||
                         sidecar->node_materials.count || sidecar->drop.count || sidecar->damage_hide.count;
    for (int m = 0; m < scene->mesh_count; m++, meshes++) unnamed += is_unnamed(scene->node[scene->mesh[m].node].name);
    if (by_name && unnamed > 0)
        log_warn("model: %s: %d of %d meshes hang on nodes without a name, which a sidecar's patterns can hardly tell "
                 "apart: "
                 "name them in the program that made the file (`pitviper model info` lists what they are called here)",
                 file, unnamed, meshes);
}

void import_count_names(int *unnamed, int *shared, const ImportScene *scene)
{
    *unnamed = *shared = 0;
    if (scene->node_count > 4096) return; /* pairs of them would take long */
    for (int i = 0; i < scene->node_count; i++) {
        *unnamed += is_unnamed(scene->node[i].name);
        *shared += scene->node[i].name[0] && times_named(scene, scene->node[i].name) > 1;
    }
}
