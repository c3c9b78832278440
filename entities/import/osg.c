/* entities/import/osg.c: OpenFlight through osgconv's text, converted to a scene.
 *
 * OpenSceneGraph's own reader turns the records into nodes, metres and polygons; its text form keeps names, degrees of
 * freedom and geometry. */
#include "entities/import/model_import_private.h"

#include <stdlib.h>

/* ---- the tree as a scene ------------------------------------------------------------------------------------- */

typedef struct Walk {
    OsgText    *x;
    ImportScene s;
    int         node_room, mesh_room, vertex_room, triangle_room, dof_room, material_room;
    int         visits;
} Walk;

/* Makes room for `more` items in a growing array; returns false when there is no memory. */
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

/* Reads rows of four; OpenSceneGraph multiplies from the left, so this transposes. */
static bool read_matrix(double m[12], const OsgText *x, int element)
{
    if (element < 0) return false;
    int row = x->element[element].child;
    for (int r = 0; r < 4; r++, row = row >= 0 ? x->element[row].next : -1) {
        double v[4];
        if (!osg_numbers(v, 4, x, row, 0)) return false;
        for (int i = 0; i < 3; i++) m[4 * i + r] = v[i];
    }
    return true;
}

/* A degree of freedom's zero: a rotation and a position that lead from its parent's axes into its own. */
typedef struct Freedom {
    double r_own_from_parent[9], p_parent[3];
} Freedom;

static bool read_freedom(Freedom *out, const OsgText *x, int element)
{
    double    put[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, t[3], lengths = 0;
    const int matrix = osg_find(x, element, "PutMatrix");
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

/* Adds a chain of nodes, one for each freedom of the transform: slides, heading, pitch, roll. Returns the last one. */
static Status add_freedoms(int *out, Walk *w, int element, const char *name, int parent)
{
    static const struct {
        const char *low, *high, *step, *current, *tail;
        int         component, axis; /* component: of H P R or x y z; axis: of the transform's own axes */
        bool        slides;
        uint32_t    limited; /* its bit in LimitationFlags */
    } freedom[6] = {
        {"MinTranslate", "MaxTranslate", "IncrementTranslate", "CurrentTranslate", ".x", 0, 0, true, 1u << 31},
        {"MinTranslate", "MaxTranslate", "IncrementTranslate", "CurrentTranslate", ".y", 1, 1, true, 1u << 30},
        {"MinTranslate", "MaxTranslate", "IncrementTranslate", "CurrentTranslate", ".z", 2, 2, true, 1u << 29},
        {"MinHPR", "MaxHPR", "IncrementHPR", "CurrentHPR", "", 0, 2, false, 1u << 26},
        {"MinHPR", "MaxHPR", "IncrementHPR", "CurrentHPR", ".pitch", 1, 0, false, 1u << 28},
        {"MinHPR", "MaxHPR", "IncrementHPR", "CurrentHPR", ".roll", 2, 1, false, 1u << 27},
    };
    const OsgText *x = w->x;
    ImportScene   *s = &w->s;
    Freedom        zero;
    long long      flags = 0;
    bool           first = true;
    if (!read_freedom(&zero, x, element))
        return refuse(w, "the place of a degree of freedom is not a rotation and a point");
    const int flag_element = osg_find(x, element, "LimitationFlags");
    if (flag_element >= 0 && !text_to_long(&flags, osg_word(x, flag_element, 1)))
        return refuse(w, "LimitationFlags is not a number");
    *out = parent;
    for (int f = 0; f < 6; f++) {
        double low[3] = {0}, high[3] = {0}, step[3] = {0}, current[3] = {0};
        osg_numbers(low, 3, x, osg_find(x, element, freedom[f].low), 1);
        osg_numbers(high, 3, x, osg_find(x, element, freedom[f].high), 1);
        osg_numbers(step, 3, x, osg_find(x, element, freedom[f].step), 1);
        osg_numbers(current, 3, x, osg_find(x, element, freedom[f].current), 1);
        const int  c = freedom[f].component;
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
    osg_numbers(scale_low, 3, x, osg_find(x, element, "MinScale"), 1);
    osg_numbers(scale_high, 3, x, osg_find(x, element, "MaxScale"), 1);
    for (int i = 0; i < 3; i++) s->lost[LOST_FREEDOM_OFFSETS] += scale_high[i] > scale_low[i];
    return first ? add_node(out, w, name, parent) : STATUS_OK;
}

/* ---- geometry -------------------------------------------------------------------------------------------------- */

/* The `vector n { ... }` of the array that a property holds, all its lines; calls for each number in turn. */
static int array_numbers(double *out, int room, const OsgText *x, int property)
{
    if (property < 0 || x->element[property].child < 0) return -1;
    const int list = osg_find(x, osg_resolve(x, x->element[property].child), "vector");
    int       count = 0;
    if (list < 0) return -1;
    for (int line = x->element[list].child; line >= 0; line = x->element[line].next)
        for (int i = 0; i < x->element[line].words; i++, count++) {
            double v;
            if (!text_to_double(&v, osg_word(x, line, i))) return -1;
            if (count < room) out[count] = v;
        }
    return count;
}

static Status add_triangle(Walk *w, ImportMesh *mesh, long long a, long long b, long long c)
{
    ImportScene    *s = &w->s;
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

/* Adds one run of `count` vertices. index: their indices; NULL: first, first + 1 ... */
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
    const OsgText *x = w->x;
    const char    *kind = osg_word(x, set, 0);
    const int      mode = osg_find(x, set, "Mode"), first_element = osg_find(x, set, "First"),
              count_element = osg_find(x, set, "Count");
    long long first = 0, count = 0;
    if (mode < 0) return STATUS_OK;
    if (first_element >= 0 &&
        (!text_to_long(&first, osg_word(x, first_element, 1)) || first < 0 || first > import_max_vertices))
        return refuse(w, "First is out of range");
    if (strcmp(kind, "osg::DrawArrays") == 0) {
        if (count_element < 0 || !text_to_long(&count, osg_word(x, count_element, 1)) || count < 0 ||
            count > import_max_vertices)
            return refuse(w, "Count is out of range");
        return add_primitive(w, mesh, osg_word(x, mode, 1), first, (int)count, NULL);
    }
    /* the numbers lie in the set itself */
    const int list = osg_find(x, set, "vector");
    int       total = 0, at = 0;
    if (list < 0) return STATUS_OK;
    for (int line = x->element[list].child; line >= 0; line = x->element[line].next) total += x->element[line].words;
    double *value = malloc(((size_t)total + 1) * sizeof *value);
    Status  status = value ? STATUS_OK : STATUS_NO_MEMORY;
    for (int line = x->element[list].child; line >= 0 && status == STATUS_OK; line = x->element[line].next)
        for (int i = 0; i < x->element[line].words && status == STATUS_OK; i++, at++)
            if (!text_to_double(value + at, osg_word(x, line, i)) ||
                !(value[at] >= 0 && value[at] <= import_max_vertices))
                status = refuse(w, "an index or a length is out of range");
    if (status == STATUS_OK && strcmp(kind, "osg::DrawArrayLengths") == 0) {
        for (int i = 0; i < total && status == STATUS_OK; first += (long long)value[i++])
            status = add_primitive(w, mesh, osg_word(x, mode, 1), first, (int)value[i], NULL);
    } else if (status == STATUS_OK) {
        status = add_primitive(w, mesh, osg_word(x, mode, 1), 0, total, value);
    }
    free(value);
    return status;
}

/* Adds the material of a geometry, by its colour and its material's name. */
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
    const OsgText *x = w->x;
    double         rgb[4] = {0};
    float          colour[3] = {0};
    const int      diffuse = osg_find(x, material, "Diffuse"), name = osg_find(x, material, "Name");
    bool           has = osg_numbers(rgb, 3, x, diffuse, 3); /* Diffuse TRUE Front r g b a Back ... */
    if (array_numbers(rgb, 4, x, osg_find(x, geometry, "ColorArray")) >= 3) has = true;
    char text[model_name_size];
    snprintf(text, sizeof text, "%s", name >= 0 ? osg_word(x, name, 1) : "");
    /* screen colours, as OpenFlight has them */
    for (int i = 0; i < 3; i++) colour[i] = has ? (float)pow(clamp(rgb[i], 0, 1), 2.2) : 0;
    if (!*text && has)
        snprintf(text, sizeof text, "colour_%02x%02x%02x", (unsigned)lrint(255 * clamp(rgb[0], 0, 1)),
                 (unsigned)lrint(255 * clamp(rgb[1], 0, 1)), (unsigned)lrint(255 * clamp(rgb[2], 0, 1)));
    return add_material(out, w, *text ? text : "default", colour, has);
}

static Status add_geometry(Walk *w, int geometry, int node, int material)
{
    const OsgText *x = w->x;
    ImportScene   *s = &w->s;
    const int      vertices = osg_find(x, geometry, "VertexArray"), sets = osg_find(x, geometry, "PrimitiveSetList");
    const int      values = array_numbers(NULL, 0, x, vertices);
    if (values <= 0 || values % 3 != 0 || sets < 0)
        return STATUS_OK; /* it is a text or a shape, which has no triangles */
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
    Status  status = normals ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        mesh.has_normals = array_numbers(normals, values, x, osg_find(x, geometry, "NormalArray")) == values;
        for (int i = 0; i < values; i++)
            s->normal[s->vertex_count + i / 3][i % 3] = mesh.has_normals ? (float)normals[i] : 0;
        status = read_material(&mesh.material, w, geometry, material);
    }
    free(normals);
    s->vertex_count += count;
    for (int set = x->element[sets].child; set >= 0 && status == STATUS_OK; set = x->element[set].next)
        status = add_primitives(w, &mesh, osg_resolve(x, set));
    s->mesh[s->mesh_count++] = mesh;
    return status;
}

/* The osg::Material in an object's state, or else the one from above. */
static int material_of(const OsgText *x, int object, int above)
{
    const int state = osg_find(x, object, "StateSet");
    if (state < 0 || x->element[state].child < 0) return above;
    const int list = osg_find(x, osg_resolve(x, x->element[state].child), "AttributeList");
    const int material = osg_find(x, list, "osg::Material");
    return material >= 0 ? osg_resolve(x, material) : above;
}

/* ---- nodes --------------------------------------------------------------------------------------- */

/* The least distance at which a level of detail is drawn; INFINITY for other objects. */
static double nearest_range(const OsgText *x, int object)
{
    const int list = strstr(osg_word(x, object, 0), "LOD") ? osg_find(x, object, "RangeList") : -1;
    double    least = INFINITY, low;
    for (int line = list >= 0 ? x->element[list].child : -1; line >= 0; line = x->element[line].next)
        if (osg_numbers(&low, 1, x, line, 0) && low < least) least = low;
    return least;
}

/* Whether child `index` of a switch, or of levels of detail, is visible. */
static bool is_seen(Walk *w, int object, const char *kind, int index, int children)
{
    const OsgText *x = w->x;
    if (strstr(kind, "LOD")) {
        /* the finest: the one that is drawn nearest by */
        const int list = osg_find(x, object, "RangeList");
        double    least = INFINITY;
        int       finest = 0, i = 0;
        for (int line = list >= 0 ? x->element[list].child : -1; line >= 0; line = x->element[line].next, i++) {
            double low;
            if (!osg_numbers(&low, 1, x, line, 0) || !(low < least)) continue;
            least = low;
            finest = i;
        }
        const bool seen = index == (finest < children ? finest : 0);
        w->s.lost[LOST_LEVELS_OF_DETAIL] += !seen;
        return seen;
    }
    if (strstr(kind, "Switch")) {
        /* ValueList n { TRUE FALSE ... } of a switch; Values n { m { TRUE ... } } of one with several: the first */
        int list = osg_find(x, object, "ValueList");
        if (list < 0 && (list = osg_find(x, object, "Values")) >= 0) list = x->element[list].child;
        int i = 0;
        for (int line = list >= 0 ? x->element[list].child : -1; line >= 0; line = x->element[line].next)
            for (int k = 0; k < x->element[line].words; k++, i++)
                if (i == index && strcmp(osg_word(x, line, k), "FALSE") == 0) {
                    w->s.lost[LOST_SWITCHED_OFF]++;
                    return false;
                }
    }
    return true;
}

static Status walk_object(Walk *w, int element, int parent, int material, int depth)
{
    const OsgText *x = w->x;
    const int      object = osg_resolve(x, element), name_element = osg_find(x, object, "Name");
    const char    *kind = osg_word(x, object, 0), *name = name_element >= 0 ? osg_word(x, name_element, 1) : "";
    int            node = parent;
    Status         status = STATUS_OK;
    if (depth > import_max_depth) return refuse(w, "more than 256 levels of nodes");
    if (++w->visits > 4 * import_max_nodes) return refuse(w, "more than 262144 nodes, as often as they are drawn");
    material = material_of(x, object, material);
    if (strcmp(kind, "osg::Geometry") == 0) return add_geometry(w, object, parent, material);
    if (strcmp(kind, "osg::LightSource") == 0) w->s.lost[LOST_LIGHTS]++;
    if (strcmp(kind, "osg::ProxyNode") == 0) w->s.lost[LOST_EXTERNAL_REFERENCES]++;

    const int drawables = osg_find(x, object, "Drawables"), children = osg_find(x, object, "Children");
    if (strcmp(kind, "osgSim::DOFTransform") == 0) {
        status = add_freedoms(&node, w, object, name, parent);
    } else if (drawables < 0 || parent < 0) {
        /* a Geode's own name is that of its first face: its triangles belong to the node above */
        status = add_node(&node, w, name, parent);
        if (status == STATUS_OK && strcmp(kind, "osg::MatrixTransform") == 0) {
            const int matrix = osg_find(x, object, "Matrix");
            if (matrix >= 0 && !read_matrix(w->s.node[node].m, x, matrix))
                return refuse(w, "a matrix is not 4 x 4 numbers");
        }
    }
    if (drawables < 0 && children < 0 && !strstr(kind, "Group") && !strstr(kind, "Light") && !strstr(kind, "Proxy"))
        w->s.lost[LOST_OTHER]++;
    for (int c = drawables >= 0 ? x->element[drawables].child : -1; c >= 0 && status == STATUS_OK;
         c = x->element[c].next)
        status = walk_object(w, c, node, material, depth + 1);
    int    count = 0, index = 0;
    double near = INFINITY;
    for (int c = children >= 0 ? x->element[children].child : -1; c >= 0; c = x->element[c].next, count++)
        near = fmin(near, nearest_range(x, osg_resolve(x, c)));
    for (int c = children >= 0 ? x->element[children].child : -1; c >= 0 && status == STATUS_OK;
         c = x->element[c].next, index++) {
        const double range = nearest_range(x, osg_resolve(x, c));
        if (isfinite(range) && range > near)
            w->s.lost[LOST_LEVELS_OF_DETAIL]++; /* OpenFlight writes levels of detail as neighbours */
        else if (is_seen(w, object, kind, index, count)) status = walk_object(w, c, node, material, depth + 1);
    }
    return status;
}

Status import_osgt(ImportScene *out, const char *path, char *text, size_t octets)
{
    OsgText x;
    Status  status = osg_text_open(&x, path, text, octets);
    Walk    w = {.x = &x,
                 .s = {.forward = {0, 1, 0},
                       .up = {0, 0, 1},
                       .unit_m = 1, /* OpenFlight's unit here */
                       .unit_from = "the unit of the file's header, turned to metres by osgconv",
                       .axes_from = "OpenFlight's habit"}};
    if (status == STATUS_BAD_VALUE) refuse(&w, "what osgconv wrote is not a whole scene");
    for (int e = 0; e < x.element_count && status == STATUS_OK; e++) {
        const char *kind = osg_word(&x, e, 0);
        if (strncmp(kind, "osg::Texture", 12) == 0 && osg_resolve(&x, e) == e) w.s.lost[LOST_TEXTURES]++;
    }
    if (status == STATUS_OK) status = walk_object(&w, 0, -1, -1, 1);
    osg_text_close(&x);
    if (status == STATUS_OK) *out = w.s;
    else import_scene_close(&w.s);
    return status;
}
