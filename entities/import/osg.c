/* entities/import/osg.c: OpenFlight by way of osgconv's text.
 *
 * OpenSceneGraph's own reader turns the records into nodes, metres and polygons; its text form keeps names, degrees of
 * freedom and geometry, and is read here: one element a line, `{` opens what belongs to it. The conversion runs in a
 * process of its own, with limits on time and memory. */
#include "entities/import/model_import_private.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* ---- the text as a tree -------------------------------------------------------------------------------------- */

typedef struct Element {
    int first_word, words;
    int child, next; /* -1: none */
} Element;

typedef struct Text {
    const char *path;
    int element_count, element_room, word_count, word_room;
    Element *element;
    char **word;
    int *by_id; /* element with this UniqueID that says more than the id; -1 */
    int id_count;
} Text;

/* Words of one line in place; `"a b"` is one, without its quotes. False: no memory. */
static bool split_words(Text *x, char *line)
{
    for (char *at = line;;) {
        while (*at == ' ' || *at == '\t' || *at == '\r') at++;
        if (!*at) return true;
        if (x->word_count == x->word_room) {
            const int room = x->word_room ? 2 * x->word_room : 4096;
            char **grown = realloc(x->word, (size_t)room * sizeof *grown);
            if (!grown) return false;
            x->word = grown;
            x->word_room = room;
        }
        if (*at == '"') {
            char *to = ++at;
            x->word[x->word_count++] = at;
            while (*at && *at != '"') {
                if (*at == '\\' && at[1]) at++;
                *to++ = *at++;
            }
            if (*at) at++;
            *to = 0;
        } else {
            x->word[x->word_count++] = at;
            while (*at && *at != ' ' && *at != '\t' && *at != '\r') at++;
            if (*at) *at++ = 0;
        }
    }
}

static const char *word(const Text *x, int element, int index)
{
    const Element *e = &x->element[element];
    return index < e->words ? x->word[e->first_word + index] : "";
}

static Status read_tree(Text *x, char *text)
{
    enum { depth_max = 2048 };
    int open[depth_max], last[depth_max];
    int depth = 0;
    open[0] = last[0] = -1;
    for (char *line = text, *next; line; line = next) {
        next = strchr(line, '\n');
        if (next) *next++ = 0;
        const int first = x->word_count;
        if (*line == '#') continue;
        if (!split_words(x, line)) return STATUS_NO_MEMORY;
        int words = x->word_count - first;
        if (words == 0) continue;
        if (words == 1 && strcmp(x->word[first], "}") == 0) {
            if (depth == 0) return STATUS_BAD_VALUE;
            depth--;
            x->word_count = first;
            continue;
        }
        const bool opens = strcmp(x->word[first + words - 1], "{") == 0;
        if (opens) words--;
        if (x->element_count == x->element_room) {
            const int room = x->element_room ? 2 * x->element_room : 4096;
            Element *grown = realloc(x->element, (size_t)room * sizeof *grown);
            if (!grown) return STATUS_NO_MEMORY;
            x->element = grown;
            x->element_room = room;
        }
        const int e = x->element_count++;
        x->element[e] = (Element){first, words, -1, -1};
        if (last[depth] >= 0)
            x->element[last[depth]].next = e;
        else if (open[depth] >= 0)
            x->element[open[depth]].child = e;
        last[depth] = e;
        if (!opens) continue;
        if (++depth == depth_max) return STATUS_BAD_VALUE;
        open[depth] = e;
        last[depth] = -1;
    }
    return depth == 0 && x->element_count > 0 ? STATUS_OK : STATUS_BAD_VALUE;
}

/* The child whose first word this is; -1: none. */
static int find(const Text *x, int element, const char *name)
{
    if (element < 0) return -1;
    for (int c = x->element[element].child; c >= 0; c = x->element[c].next)
        if (strcmp(word(x, c, 0), name) == 0) return c;
    return -1;
}

static long long id_of(const Text *x, int element)
{
    long long id = -1;
    const int c = find(x, element, "UniqueID");
    return c >= 0 && text_to_long(&id, word(x, c, 1)) && id >= 0 && id < x->id_count ? id : -1;
}

/* An object said a second time is its id alone. */
static int resolve(const Text *x, int element)
{
    const long long id = id_of(x, element);
    return id >= 0 && x->by_id[id] >= 0 ? x->by_id[id] : element;
}

static Status number_objects(Text *x)
{
    x->id_count = x->element_count + 1; /* ids count objects, and an object is more than one element */
    x->by_id = malloc((size_t)x->id_count * sizeof *x->by_id);
    if (!x->by_id) return STATUS_NO_MEMORY;
    for (int i = 0; i < x->id_count; i++) x->by_id[i] = -1;
    for (int e = 0; e < x->element_count; e++) {
        const int first = x->element[e].child;
        const long long id = first >= 0 && x->element[first].next >= 0 ? id_of(x, e) : -1;
        if (id >= 0 && x->by_id[id] < 0) x->by_id[id] = e;
    }
    return STATUS_OK;
}

/* Numbers among an element's words from `from` on; false when there are fewer than count. */
static bool numbers(double *out, int count, const Text *x, int element, int from)
{
    for (int i = 0; i < count; i++)
        if (element < 0 || !text_to_double(out + i, word(x, element, from + i))) return false;
    return true;
}

/* ---- the tree as a scene ------------------------------------------------------------------------------------- */

typedef struct Walk {
    Text *x;
    ImportScene s;
    int node_room, mesh_room, vertex_room, triangle_room, dof_room, material_room;
    int visits;
} Walk;

/* Room for `more` in a growing array; false: no memory. */
static bool grow(void *array, int *room, int count, int more, size_t size)
{
    void *old;
    if (count + more <= *room) return true;
    int larger = *room ? *room : 64;
    while (larger < count + more) larger *= 2;
    memcpy(&old, array, sizeof old);
    void *grown = realloc(old, (size_t)larger * size);
    if (!grown) return false;
    memcpy(array, &grown, sizeof grown);
    *room = larger;
    return true;
}

static Status refuse(Walk *w, const char *why)
{
    log_error("model: cannot be read: file=%s: %s", w->x->path, why);
    return STATUS_BAD_VALUE;
}

static Status add_node(int *out, Walk *w, const char *name, int parent)
{
    ImportScene *s = &w->s;
    if (s->node_count == import_max_nodes) return refuse(w, "more than 65536 nodes");
    if (!grow(&s->node, &w->node_room, s->node_count, 1, sizeof *s->node)) return STATUS_NO_MEMORY;
    ImportNode *node = &s->node[s->node_count];
    *node = (ImportNode){.parent = parent, .m = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    snprintf(node->name, sizeof node->name, "%s", name);
    *out = s->node_count++;
    return STATUS_OK;
}

/* Rows of four; OpenSceneGraph multiplies from the left, so this transposes. */
static bool read_matrix(double m[12], const Text *x, int element)
{
    if (element < 0) return false;
    int row = x->element[element].child;
    for (int r = 0; r < 4; r++, row = row >= 0 ? x->element[row].next : -1) {
        double v[4];
        if (!numbers(v, 4, x, row, 0)) return false;
        for (int i = 0; i < 3; i++) m[4 * i + r] = v[i];
    }
    return true;
}

/* A degree of freedom's zero: from its parent's axes into its own, a rotation and a place. */
typedef struct Freedom {
    double r_own_from_parent[9], p_parent[3];
} Freedom;

static bool read_freedom(Freedom *out, const Text *x, int element)
{
    double put[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, t[3], lengths = 0;
    const int matrix = find(x, element, "PutMatrix");
    if (matrix >= 0 && !read_matrix(put, x, matrix)) return false;
    for (int i = 0; i < 3; i++) {
        double *row = out->r_own_from_parent + 3 * i;
        memcpy(row, put + 4 * i, 3 * sizeof *row);
        lengths += fabs(v3_length(row) - 1);
        t[i] = -put[4 * i + 3];
    }
    m3_tmul_v3(out->p_parent, out->r_own_from_parent, t);
    return lengths < 1e-3;
}

/* A chain of nodes, one for each freedom that the transform has: slides, heading, pitch, roll. Returns the last. */
static Status add_freedoms(int *out, Walk *w, int element, const char *name, int parent)
{
    static const struct {
        const char *low, *high, *step, *current, *tail;
        int component, axis; /* of H P R or x y z; of the transform's own axes */
        bool slides;
        uint32_t limited; /* bit of LimitationFlags */
    } freedom[6] = {
        {"MinTranslate", "MaxTranslate", "IncrementTranslate", "CurrentTranslate", ".x", 0, 0, true, 1u << 31},
        {"MinTranslate", "MaxTranslate", "IncrementTranslate", "CurrentTranslate", ".y", 1, 1, true, 1u << 30},
        {"MinTranslate", "MaxTranslate", "IncrementTranslate", "CurrentTranslate", ".z", 2, 2, true, 1u << 29},
        {"MinHPR", "MaxHPR", "IncrementHPR", "CurrentHPR", "", 0, 2, false, 1u << 26},
        {"MinHPR", "MaxHPR", "IncrementHPR", "CurrentHPR", ".pitch", 1, 0, false, 1u << 28},
        {"MinHPR", "MaxHPR", "IncrementHPR", "CurrentHPR", ".roll", 2, 1, false, 1u << 27},
    };
    const Text *x = w->x;
    ImportScene *s = &w->s;
    Freedom zero;
    long long flags = 0;
    bool first = true;
    if (!read_freedom(&zero, x, element))
        return refuse(w, "the place of a degree of freedom is not a rotation and a point");
    const int flag_element = find(x, element, "LimitationFlags");
    if (flag_element >= 0 && !text_to_long(&flags, word(x, flag_element, 1)))
        return refuse(w, "LimitationFlags is not a number");
    *out = parent;
    for (int f = 0; f < 6; f++) {
        double low[3] = {0}, high[3] = {0}, step[3] = {0}, current[3] = {0};
        numbers(low, 3, x, find(x, element, freedom[f].low), 1);
        numbers(high, 3, x, find(x, element, freedom[f].high), 1);
        numbers(step, 3, x, find(x, element, freedom[f].step), 1);
        numbers(current, 3, x, find(x, element, freedom[f].current), 1);
        const int c = freedom[f].component;
        const bool limited = (uint32_t)flags & freedom[f].limited;
        if (current[c] != 0) s->lost[LOST_FREEDOM_OFFSETS]++;
        if (!(high[c] > low[c] || (step[c] != 0 && !limited)) || (freedom[f].slides && !limited)) continue;
        char own[model_name_size];
        snprintf(own, sizeof own, "%.80s%s", name, first ? "" : freedom[f].tail);
        first = false;
        const Status status = add_node(out, w, own, *out);
        if (status != STATUS_OK) return status;
        if (!grow(&s->dof, &w->dof_room, s->dof_count, 1, sizeof *s->dof)) return STATUS_NO_MEMORY;
        ImportDof *dof = &s->dof[s->dof_count++];
        *dof =
            (ImportDof){.node = *out, .slides = freedom[f].slides, .limited = limited, .low = low[c], .high = high[c]};
        memcpy(dof->p_pivot_parent, zero.p_parent, sizeof dof->p_pivot_parent);
        memcpy(dof->axis_parent, zero.r_own_from_parent + 3 * freedom[f].axis, sizeof dof->axis_parent);
    }
    double scale_low[3] = {1, 1, 1}, scale_high[3] = {1, 1, 1};
    numbers(scale_low, 3, x, find(x, element, "MinScale"), 1);
    numbers(scale_high, 3, x, find(x, element, "MaxScale"), 1);
    for (int i = 0; i < 3; i++) s->lost[LOST_FREEDOM_OFFSETS] += scale_high[i] > scale_low[i];
    return first ? add_node(out, w, name, parent) : STATUS_OK;
}

/* ---- geometry -------------------------------------------------------------------------------------------------- */

/* The `vector n { ... }` of the array that a property holds, all its lines; calls for each number in turn. */
static int array_numbers(double *out, int room, const Text *x, int property)
{
    if (property < 0 || x->element[property].child < 0) return -1;
    const int list = find(x, resolve(x, x->element[property].child), "vector");
    int count = 0;
    if (list < 0) return -1;
    for (int line = x->element[list].child; line >= 0; line = x->element[line].next)
        for (int i = 0; i < x->element[line].words; i++, count++) {
            double v;
            if (!text_to_double(&v, word(x, line, i))) return -1;
            if (count < room) out[count] = v;
        }
    return count;
}

static Status add_triangle(Walk *w, ImportMesh *mesh, long long a, long long b, long long c)
{
    ImportScene *s = &w->s;
    const long long corner[3] = {a, b, c};
    if (s->triangle_count == import_max_triangles) return refuse(w, "more than 8 M triangles");
    if (!grow(&s->triangle, &w->triangle_room, s->triangle_count, 1, sizeof *s->triangle)) return STATUS_NO_MEMORY;
    for (int k = 0; k < 3; k++) {
        if (corner[k] < 0 || corner[k] >= mesh->vertex_count) return refuse(w, "a vertex index is out of range");
        s->triangle[s->triangle_count][k] = (uint32_t)corner[k];
    }
    s->triangle_count++;
    mesh->triangle_count++;
    return STATUS_OK;
}

/* One run of `count` vertices; index: NULL for first, first + 1 ... */
static Status add_primitive(Walk *w, ImportMesh *mesh, const char *mode, long long first, int count,
                            const double *index)
{
#define AT(i) (index ? (long long)index[i] : first + (i))
    Status status = STATUS_OK;
    if (strcmp(mode, "TRIANGLES") == 0) {
        for (int i = 0; i + 2 < count && status == STATUS_OK; i += 3)
            status = add_triangle(w, mesh, AT(i), AT(i + 1), AT(i + 2));
    } else if (strcmp(mode, "TRIANGLE_STRIP") == 0 || strcmp(mode, "QUAD_STRIP") == 0) {
        for (int i = 0; i + 2 < count && status == STATUS_OK; i++)
            status = i % 2 ? add_triangle(w, mesh, AT(i + 1), AT(i), AT(i + 2))
                           : add_triangle(w, mesh, AT(i), AT(i + 1), AT(i + 2));
    } else if (strcmp(mode, "TRIANGLE_FAN") == 0 || strcmp(mode, "POLYGON") == 0) {
        for (int i = 1; i + 1 < count && status == STATUS_OK; i++)
            status = add_triangle(w, mesh, AT(0), AT(i), AT(i + 1));
    } else if (strcmp(mode, "QUADS") == 0) {
        for (int i = 0; i + 3 < count && status == STATUS_OK; i += 4) {
            status = add_triangle(w, mesh, AT(i), AT(i + 1), AT(i + 2));
            if (status == STATUS_OK) status = add_triangle(w, mesh, AT(i), AT(i + 2), AT(i + 3));
        }
    } else {
        w->s.lost[LOST_POINTS_AND_LINES]++;
    }
#undef AT
    return status;
}

static Status add_primitives(Walk *w, ImportMesh *mesh, int set)
{
    const Text *x = w->x;
    const char *kind = word(x, set, 0);
    const int mode = find(x, set, "Mode"), first_element = find(x, set, "First"), count_element = find(x, set, "Count");
    long long first = 0, count = 0;
    if (mode < 0) return STATUS_OK;
    if (first_element >= 0 &&
        (!text_to_long(&first, word(x, first_element, 1)) || first < 0 || first > import_max_vertices))
        return refuse(w, "First is out of range");
    if (strcmp(kind, "osg::DrawArrays") == 0) {
        if (count_element < 0 || !text_to_long(&count, word(x, count_element, 1)) || count < 0 ||
            count > import_max_vertices)
            return refuse(w, "Count is out of range");
        return add_primitive(w, mesh, word(x, mode, 1), first, (int)count, NULL);
    }
    /* the numbers lie in the set itself */
    const int list = find(x, set, "vector");
    int total = 0, at = 0;
    if (list < 0) return STATUS_OK;
    for (int line = x->element[list].child; line >= 0; line = x->element[line].next) total += x->element[line].words;
    double *value = malloc(((size_t)total + 1) * sizeof *value);
    Status status = value ? STATUS_OK : STATUS_NO_MEMORY;
    for (int line = x->element[list].child; line >= 0 && status == STATUS_OK; line = x->element[line].next)
        for (int i = 0; i < x->element[line].words && status == STATUS_OK; i++, at++)
            if (!text_to_double(value + at, word(x, line, i)) || !(value[at] >= 0 && value[at] <= import_max_vertices))
                status = refuse(w, "an index or a length is out of range");
    if (status == STATUS_OK && strcmp(kind, "osg::DrawArrayLengths") == 0) {
        for (int i = 0; i < total && status == STATUS_OK; first += (long long)value[i++])
            status = add_primitive(w, mesh, word(x, mode, 1), first, (int)value[i], NULL);
    } else if (status == STATUS_OK) {
        status = add_primitive(w, mesh, word(x, mode, 1), 0, total, value);
    }
    free(value);
    return status;
}

/* Material of a geometry: its colour, its material's name. */
static Status add_material(int *out, Walk *w, const char *name, const float rgb[3], bool has_colour)
{
    ImportScene *s = &w->s;
    for (int i = 0; i < s->material_count; i++)
        if (strcmp(s->material[i].name, name) == 0 && s->material[i].has_colour == has_colour &&
            memcmp(s->material[i].rgb, rgb, sizeof s->material[i].rgb) == 0) {
            *out = i;
            return STATUS_OK;
        }
    if (s->material_count == import_max_materials) return refuse(w, "more than 16384 materials");
    if (!grow(&s->material, &w->material_room, s->material_count, 1, sizeof *s->material)) return STATUS_NO_MEMORY;
    ImportMaterial *material = &s->material[s->material_count];
    *material = (ImportMaterial){.has_colour = has_colour};
    snprintf(material->name, sizeof material->name, "%s", name);
    memcpy(material->rgb, rgb, sizeof material->rgb);
    *out = s->material_count++;
    return STATUS_OK;
}

/* state: the nearest StateSet's osg::Material, -1: none. */
static Status read_material(int *out, Walk *w, int geometry, int material)
{
    const Text *x = w->x;
    double rgb[4] = {0};
    float colour[3] = {0};
    const int diffuse = find(x, material, "Diffuse"), name = find(x, material, "Name");
    bool has = numbers(rgb, 3, x, diffuse, 3); /* Diffuse TRUE Front r g b a Back ... */
    if (array_numbers(rgb, 4, x, find(x, geometry, "ColorArray")) >= 3) has = true;
    char text[model_name_size];
    snprintf(text, sizeof text, "%s", name >= 0 ? word(x, name, 1) : "");
    /* screen colours, as OpenFlight has them */
    for (int i = 0; i < 3; i++) colour[i] = has ? (float)pow(clamp(rgb[i], 0, 1), 2.2) : 0;
    if (!*text && has)
        snprintf(text, sizeof text, "colour_%02x%02x%02x", (unsigned)lrint(255 * clamp(rgb[0], 0, 1)),
                 (unsigned)lrint(255 * clamp(rgb[1], 0, 1)), (unsigned)lrint(255 * clamp(rgb[2], 0, 1)));
    return add_material(out, w, *text ? text : "default", colour, has);
}

static Status add_geometry(Walk *w, int geometry, int node, int material)
{
    const Text *x = w->x;
    ImportScene *s = &w->s;
    const int vertices = find(x, geometry, "VertexArray"), sets = find(x, geometry, "PrimitiveSetList");
    const int values = array_numbers(NULL, 0, x, vertices);
    if (values <= 0 || values % 3 != 0 || sets < 0) return STATUS_OK; /* text, shapes: nothing to trace */
    const int count = values / 3;
    if (count > import_max_vertices - s->vertex_count) return refuse(w, "more than 8 M vertices");
    if (s->mesh_count == import_max_meshes) return refuse(w, "more than 16384 parts");
    int normal_room = w->vertex_room;
    if (!grow(&s->normal, &normal_room, s->vertex_count, count, sizeof *s->normal) ||
        !grow(&s->vertex, &w->vertex_room, s->vertex_count, count, sizeof *s->vertex) ||
        !grow(&s->mesh, &w->mesh_room, s->mesh_count, 1, sizeof *s->mesh))
        return STATUS_NO_MEMORY;
    ImportMesh mesh = {
        .node = node, .first_vertex = s->vertex_count, .vertex_count = count, .first_triangle = s->triangle_count};
    array_numbers(s->vertex[s->vertex_count], values, x, vertices);
    double *normals = malloc((size_t)values * sizeof *normals);
    Status status = normals ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        mesh.has_normals = array_numbers(normals, values, x, find(x, geometry, "NormalArray")) == values;
        for (int i = 0; i < values; i++)
            s->normal[s->vertex_count + i / 3][i % 3] = mesh.has_normals ? (float)normals[i] : 0;
        status = read_material(&mesh.material, w, geometry, material);
    }
    free(normals);
    s->vertex_count += count;
    for (int set = x->element[sets].child; set >= 0 && status == STATUS_OK; set = x->element[set].next)
        status = add_primitives(w, &mesh, resolve(x, set));
    s->mesh[s->mesh_count++] = mesh;
    return status;
}

/* The osg::Material of an object's state, else the one that holds above it. */
static int material_of(const Text *x, int object, int above)
{
    const int state = find(x, object, "StateSet");
    if (state < 0 || x->element[state].child < 0) return above;
    const int list = find(x, resolve(x, x->element[state].child), "AttributeList");
    const int material = find(x, list, "osg::Material");
    return material >= 0 ? resolve(x, material) : above;
}

/* ---- nodes ---------------------------------------------------------------------------------------------------------
 */

/* The least distance at which a level of detail is drawn; INFINITY for what is none. */
static double nearest_range(const Text *x, int object)
{
    const int list = strstr(word(x, object, 0), "LOD") ? find(x, object, "RangeList") : -1;
    double least = INFINITY, low;
    for (int line = list >= 0 ? x->element[list].child : -1; line >= 0; line = x->element[line].next)
        if (numbers(&low, 1, x, line, 0) && low < least) least = low;
    return least;
}

/* Whether child `index` of a switch or of levels of detail is seen. */
static bool is_seen(Walk *w, int object, const char *kind, int index, int children)
{
    const Text *x = w->x;
    if (strstr(kind, "LOD")) {
        /* the finest: the one that is drawn nearest by */
        const int list = find(x, object, "RangeList");
        double least = INFINITY;
        int finest = 0, i = 0;
        for (int line = list >= 0 ? x->element[list].child : -1; line >= 0; line = x->element[line].next, i++) {
            double low;
            if (!numbers(&low, 1, x, line, 0) || !(low < least)) continue;
            least = low;
            finest = i;
        }
        const bool seen = index == (finest < children ? finest : 0);
        w->s.lost[LOST_LEVELS_OF_DETAIL] += !seen;
        return seen;
    }
    if (strstr(kind, "Switch")) {
        /* ValueList n { TRUE FALSE ... } of a switch; Values n { m { TRUE ... } } of one with several sets, the first
         */
        int list = find(x, object, "ValueList");
        if (list < 0 && (list = find(x, object, "Values")) >= 0) list = x->element[list].child;
        int i = 0;
        for (int line = list >= 0 ? x->element[list].child : -1; line >= 0; line = x->element[line].next)
            for (int k = 0; k < x->element[line].words; k++, i++)
                if (i == index && strcmp(word(x, line, k), "FALSE") == 0) {
                    w->s.lost[LOST_SWITCHED_OFF]++;
                    return false;
                }
    }
    return true;
}

static Status walk_object(Walk *w, int element, int parent, int material, int depth)
{
    const Text *x = w->x;
    const int object = resolve(x, element), name_element = find(x, object, "Name");
    const char *kind = word(x, object, 0), *name = name_element >= 0 ? word(x, name_element, 1) : "";
    int node = parent;
    Status status = STATUS_OK;
    if (depth > import_max_depth) return refuse(w, "more than 256 levels of nodes");
    if (++w->visits > 4 * import_max_nodes) return refuse(w, "more than 262144 nodes, as often as they are drawn");
    material = material_of(x, object, material);
    if (strcmp(kind, "osg::Geometry") == 0) return add_geometry(w, object, parent, material);
    if (strcmp(kind, "osg::LightSource") == 0) w->s.lost[LOST_LIGHTS]++;
    if (strcmp(kind, "osg::ProxyNode") == 0) w->s.lost[LOST_EXTERNAL_REFERENCES]++;

    const int drawables = find(x, object, "Drawables"), children = find(x, object, "Children");
    if (strcmp(kind, "osgSim::DOFTransform") == 0) {
        status = add_freedoms(&node, w, object, name, parent);
    } else if (drawables < 0 || parent < 0) {
        /* a Geode's own name is that of its first face: its triangles belong to the node above, which has the object's
         */
        status = add_node(&node, w, name, parent);
        if (status == STATUS_OK && strcmp(kind, "osg::MatrixTransform") == 0) {
            const int matrix = find(x, object, "Matrix");
            if (matrix >= 0 && !read_matrix(w->s.node[node].m, x, matrix))
                return refuse(w, "a matrix is not 4 x 4 numbers");
        }
    }
    if (drawables < 0 && children < 0 && !strstr(kind, "Group") && !strstr(kind, "Light") && !strstr(kind, "Proxy"))
        w->s.lost[LOST_OTHER]++;
    for (int c = drawables >= 0 ? x->element[drawables].child : -1; c >= 0 && status == STATUS_OK;
         c = x->element[c].next)
        status = walk_object(w, c, node, material, depth + 1);
    int count = 0, index = 0;
    double near = INFINITY;
    for (int c = children >= 0 ? x->element[children].child : -1; c >= 0; c = x->element[c].next, count++)
        near = fmin(near, nearest_range(x, resolve(x, c)));
    for (int c = children >= 0 ? x->element[children].child : -1; c >= 0 && status == STATUS_OK;
         c = x->element[c].next, index++) {
        const double range = nearest_range(x, resolve(x, c));
        if (isfinite(range) && range > near)
            w->s.lost[LOST_LEVELS_OF_DETAIL]++; /* OpenFlight's levels are neighbours */
        else if (is_seen(w, object, kind, index, count))
            status = walk_object(w, c, node, material, depth + 1);
    }
    return status;
}

Status import_osgt(ImportScene *out, const char *path, char *text, size_t octets)
{
    Text x = {.path = path};
    Walk w = {.x = &x, .s = {.forward = {0, 1, 0}, .up = {0, 0, 1}}}; /* as OpenFlight has it */
    Status status = strlen(text) == octets ? read_tree(&x, text) : STATUS_BAD_VALUE;
    if (status == STATUS_BAD_VALUE) refuse(&w, "what osgconv wrote is not a whole scene");
    if (status == STATUS_OK) status = number_objects(&x);
    for (int e = 0; e < x.element_count && status == STATUS_OK; e++) {
        const char *kind = word(&x, e, 0);
        if (strncmp(kind, "osg::Texture", 12) == 0 && resolve(&x, e) == e) w.s.lost[LOST_TEXTURES]++;
    }
    if (status == STATUS_OK) status = walk_object(&w, 0, -1, -1, 1);
    free(x.element);
    free(x.word);
    free(x.by_id);
    if (status == STATUS_OK)
        *out = w.s;
    else
        import_scene_close(&w.s);
    return status;
}

/* ---- osgconv ------------------------------------------------------------------------------------------------- */

/* Waits for a process, up to `seconds`; false: it had to be stopped. */
static bool wait_for(int *ended, pid_t child, double seconds)
{
    const double until = wall_clock_s() + seconds;
    for (;;) {
        const pid_t got = waitpid(child, ended, WNOHANG);
        if (got == child || (got < 0 && errno != EINTR)) return got == child;
        if (wall_clock_s() > until) break;
        nanosleep(&(struct timespec){0, 5000000}, NULL);
    }
    kill(child, SIGKILL);
    while (waitpid(child, ended, 0) < 0 && errno == EINTR) {
    }
    return false;
}

/* This process's environment but for what steers OpenSceneGraph: its optimizer would merge what has names. */
static char **osg_environment(void)
{
    size_t count = 0, kept = 0;
    while (environ[count]) count++;
    char **out = calloc(count + 2, sizeof *out);
    if (!out) return NULL;
    for (size_t i = 0; i < count; i++)
        if (strncmp(environ[i], "OSG_", 4) != 0) out[kept++] = environ[i];
    static char off[] = "OSG_OPTIMIZER=OFF";
    out[kept] = off;
    return out;
}

static Status convert(const char *from, const char *to, const char *path)
{
    char program[] = "osgconv", option[] = "-O", options[] = "preserveObject precision 9";
    char *argument[] = {program, option, options, (char *)(uintptr_t)from, (char *)(uintptr_t)to, NULL};
    pid_t child;
    int ended = 0;
    posix_spawn_file_actions_t actions;
    char **environment = osg_environment();
    if (!environment || posix_spawn_file_actions_init(&actions) != 0) {
        free(environment);
        return STATUS_NO_MEMORY;
    }
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    const int failed = posix_spawnp(&child, program, &actions, NULL, argument, environment);
    posix_spawn_file_actions_destroy(&actions);
    free(environment);
    if (failed) {
        log_error("model: cannot convert: file=%s: osgconv: %s%s", path, strerror(failed),
                  failed == ENOENT ? "; OpenFlight needs it: apt-get install openscenegraph" : "");
        return STATUS_IO;
    }
    const struct rlimit memory = {2 * (rlim_t)import_max_memory, 2 * (rlim_t)import_max_memory}, no_core = {0, 0},
                        size = {import_max_octets, import_max_octets};
    prlimit(child, RLIMIT_AS, &memory, NULL);
    prlimit(child, RLIMIT_CORE, &no_core, NULL);
    prlimit(child, RLIMIT_FSIZE, &size, NULL);
    if (!wait_for(&ended, child, import_max_seconds)) {
        log_error("model: cannot convert: file=%s: osgconv took more than %d s", path, import_max_seconds);
        return STATUS_BAD_VALUE;
    }
    if (!WIFEXITED(ended) || WEXITSTATUS(ended) != 0 || access(to, R_OK) != 0) {
        log_error("model: cannot convert: file=%s: osgconv gave up (%s %d): is it whole, and OpenFlight?", path,
                  WIFSIGNALED(ended) ? "signal" : "exit", WIFSIGNALED(ended) ? WTERMSIG(ended) : WEXITSTATUS(ended));
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

Status import_openflight(ImportScene *out, const char *path)
{
    const char *root = getenv("TMPDIR");
    char folder[512], text_path[560], whole[PATH_MAX];
    char *text = NULL;
    size_t octets = 0;
    if (!realpath(path, whole)) { /* so that no name looks like an option */
        log_error("model: cannot open: file=%s: %s", path, strerror(errno));
        return STATUS_IO;
    }
    if ((size_t)snprintf(folder, sizeof folder, "%s/pitviper-flt-XXXXXX", root && *root ? root : "/tmp") >=
            sizeof folder ||
        !mkdtemp(folder)) {
        log_error("model: cannot convert: file=%s: no folder for the conversion: %s", path, folder);
        return STATUS_IO;
    }
    snprintf(text_path, sizeof text_path, "%s/model.osgt", folder);
    Status status = convert(whole, text_path, path);
    if (status == STATUS_OK) status = import_read_whole(&text, &octets, text_path, false);
    if (status == STATUS_OK) status = import_osgt(out, path, text, octets);
    free(text);
    remove(text_path);
    rmdir(folder);
    return status;
}
