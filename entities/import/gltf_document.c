/* entities/import/gltf_document.c: what a glTF document has: numbers (buffers, views, accessors) and extensions. */

#include "entities/import/gltf_private.h"

#include <ctype.h>
#include <stdlib.h>
#include <strings.h>

static int base64_value(char c)
{
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

static Status from_base64(GltfBuffer *out, ReaderSaid *said, const char *text)
{
    const size_t length = strlen(text);
    out->bytes = malloc(length / 4 * 3 + 4);
    if (!out->bytes) return STATUS_NO_MEMORY;
    out->owned = true;
    uint32_t bits = 0;
    int      held = 0;
    for (size_t i = 0; i < length && text[i] != '='; i++) {
        const int value = base64_value(text[i]);
        if (value < 0) return reader_fails(said, STATUS_BAD_VALUE, "a buffer's base64 has a character that is none");
        bits = bits << 6 | (uint32_t)value;
        held += 6;
        if (held >= 8) out->bytes[out->octets++] = (char)(bits >> (held -= 8) & 255);
    }
    return STATUS_OK;
}

/* `%20` -> ` `; false: longer than a path. */
static bool from_percent(char *out, size_t size, const char *uri)
{
    size_t n = 0;
    for (; *uri && n + 1 < size; uri++) {
        unsigned   value;
        const bool coded = uri[0] == '%' && isxdigit((unsigned char)uri[1]) && isxdigit((unsigned char)uri[2]) &&
                           sscanf(uri + 1, "%2x", &value) == 1 && value != 0;
        out[n++] = coded ? (char)value : *uri;
        uri += 2 * coded;
    }
    out[n] = 0;
    return !*uri;
}

static Status read_buffer(Gltf *g, int index)
{
    GltfBuffer   *b = &g->buffer[index];
    const json_t *object = gltf_item(g, "buffers", index), *length = json_object_get(object, "byteLength");
    const char   *uri = json_string_value(json_object_get(object, "uri"));
    Status        status = STATUS_OK;
    if (b->bytes) return STATUS_OK;
    if (!uri) {
        json_t     *extensions = json_object_get(object, "extensions");
        const char *packed = json_object_iter_key(json_object_iter(extensions));
        if (packed) /* the accessor's numbers are those that the extension unpacks */
            return reader_fails(g->said, STATUS_UNSUPPORTED,
                                "buffer %d is packed by the extension %.80s, which is not read: export it without",
                                index, packed);
        if (index > 0 || !g->binary)
            return reader_fails(g->said, STATUS_BAD_VALUE, "buffer %d is neither in the file nor named", index);
        b->bytes = (char *)(uintptr_t)g->binary;
        b->octets = g->binary_octets;
    } else if (strncmp(uri, "data:", 5) == 0) {
        const char *comma = strchr(uri, ',');
        if (!comma || comma - uri < 12 || strncmp(comma - 7, ";base64", 7) != 0)
            return reader_fails(g->said, STATUS_BAD_VALUE, "buffer %d: a data URI without base64", index);
        status = from_base64(b, g->said, comma + 1);
    } else {
        char name[1000], path[2100];
        if (!from_percent(name, sizeof name, uri) || strstr(name, "://"))
            return reader_fails(g->said, STATUS_BAD_VALUE, "buffer %d is no file of its folder: %.200s", index, uri);
        snprintf(path, sizeof path, "%.*s%s", (int)g->files->folder, g->files->shown, name);
        status = reader_read(&b->bytes, &b->octets, g->files, path);
        b->owned = status == STATUS_OK;
        if (status != STATUS_OK && status != STATUS_NO_MEMORY)
            return reader_fails(g->said, STATUS_BAD_VALUE, "buffer %d cannot be read: %.200s, in the model's folder",
                                index, name);
    }
    if (status != STATUS_OK) return status;
    if (!json_is_integer(length) || json_integer_value(length) < 1 || (size_t)json_integer_value(length) > b->octets)
        return reader_fails(g->said, STATUS_BAD_VALUE,
                            "buffer %d has %zu octets, and should have more: is the file whole?", index, b->octets);
    b->octets = (size_t)json_integer_value(length);
    return STATUS_OK;
}

void gltf_buffers_close(Gltf *g)
{
    for (size_t i = 0; i < g->buffer_count; i++)
        if (g->buffer[i].owned) free(g->buffer[i].bytes);
    free(g->buffer);
}

/* ---- accessors -------------------------------------------------------------------------------------- */

/* A member that is a number of octets; `otherwise` when it is missing, -1 when it is wrong. */
static int64_t octets_of(const json_t *object, const char *key, int64_t otherwise)
{
    const json_t *value = json_object_get(object, key);
    if (!value) return otherwise;
    return json_is_integer(value) && json_integer_value(value) >= 0 && json_integer_value(value) <= import_max_octets
               ? json_integer_value(value)
               : -1;
}

static int size_of(int64_t type)
{
    switch (type) {
    case 5120:
    case 5121:
        return 1;
    case 5122:
    case 5123:
        return 2;
    case 5125:
    case 5126:
        return 4;
    default:
        return 0;
    }
}

/* KHR_mesh_quantization: normalised numbers are fractions of the largest; the least of signed ones is -1 too. */
static double number_at(const char *at, int64_t type, bool normalised)
{
    int8_t   i8;
    uint8_t  u8;
    int16_t  i16;
    uint16_t u16;
    uint32_t u32;
    float    f;
    switch (type) {
    case 5120:
        memcpy(&i8, at, 1);
        return normalised ? fmax(i8 / 127.0, -1) : i8;
    case 5121:
        memcpy(&u8, at, 1);
        return normalised ? u8 / 255.0 : u8;
    case 5122:
        memcpy(&i16, at, 2);
        return normalised ? fmax(i16 / 32767.0, -1) : i16;
    case 5123:
        memcpy(&u16, at, 2);
        return normalised ? u16 / 65535.0 : u16;
    case 5125:
        memcpy(&u32, at, 4);
        return u32;
    default:
        memcpy(&f, at, 4);
        return f;
    }
}

/* Elements of a view: `count` of `size` octets; all lie within it. */
typedef struct Elements {
    const char *what; /* name for messages */
    size_t      size, count;
    bool        strided; /* the view may have a stride */
} Elements;

/* Where element i of a view begins: *base + i * *stride. */
static Status view_at(const char **base, size_t *stride, Gltf *g, int view, int64_t offset, const Elements *elements)
{
    const char   *what = elements->what;
    const size_t  size = elements->size, count = elements->count;
    const json_t *object = gltf_item(g, "bufferViews", view);
    const int     buffer = gltf_index(object, "buffer", g->buffer_count);
    const int64_t from = octets_of(object, "byteOffset", 0), length = octets_of(object, "byteLength", -1);
    const int64_t step = elements->strided ? octets_of(object, "byteStride", (int64_t)size) : (int64_t)size;
    if (buffer < 0 || from < 0 || length < 0 || offset < 0 || step < (int64_t)size || step > 252 + (int64_t)size)
        return reader_fails(g->said, STATUS_BAD_VALUE, "%s: bufferView %d is wrong", what, view);
    const Status status = read_buffer(g, buffer);
    if (status != STATUS_OK) return status;
    if (from + length > (int64_t)g->buffer[buffer].octets ||
        offset + step * (int64_t)(count - 1) + (int64_t)size > length)
        return reader_fails(g->said, STATUS_BAD_VALUE, "%s: bufferView %d ends before its %zu elements do", what, view,
                            count);
    *base = g->buffer[buffer].bytes + from + offset;
    *stride = (size_t)step;
    return STATUS_OK;
}

/* How the numbers of an accessor are written. */
typedef struct Numbers {
    int         components;
    int64_t     type; /* component type, as glTF numbers it */
    bool        normalised;
    const char *what; /* name for messages */
} Numbers;

/* Replaces numbers at some places by those of a sparse accessor: `indices` and `values`. */
static Status sparse(double *out, size_t count, Gltf *g, const json_t *object, const Numbers *numbers)
{
    const int     components = numbers->components;
    const int64_t type = numbers->type;
    const char   *what = numbers->what;
    const json_t *indices = json_object_get(object, "indices"), *values = json_object_get(object, "values");
    const size_t  views = json_array_size(json_object_get(g->root, "bufferViews"));
    const int64_t n = octets_of(object, "count", -1), index_type = octets_of(indices, "componentType", -1);
    const int     index_view = gltf_index(indices, "bufferView", views),
              value_view = gltf_index(values, "bufferView", views);
    const char *at, *from;
    size_t      at_step, from_step;
    if (n < 1 || (size_t)n > count || (index_type != 5121 && index_type != 5123 && index_type != 5125) ||
        index_view < 0 || value_view < 0)
        return reader_fails(g->said, STATUS_BAD_VALUE, "%s: its sparse numbers are wrong", what);
    const size_t   size = (size_t)size_of(type) * (size_t)components;
    const Elements places = {what, (size_t)size_of(index_type), (size_t)n, false},
                   others = {what, size, (size_t)n, false};
    Status status = view_at(&at, &at_step, g, index_view, octets_of(indices, "byteOffset", 0), &places);
    if (status == STATUS_OK)
        status = view_at(&from, &from_step, g, value_view, octets_of(values, "byteOffset", 0), &others);
    for (size_t i = 0; i < (size_t)n && status == STATUS_OK; i++) {
        const double place = number_at(at + i * at_step, index_type, false);
        if (place >= (double)count)
            return reader_fails(g->said, STATUS_BAD_VALUE, "%s: a sparse index is beyond its end", what);
        for (int k = 0; k < components; k++)
            out[(size_t)place * (size_t)components + (size_t)k] =
                number_at(from + i * from_step + k * size_of(type), type, numbers->normalised);
    }
    return status;
}

bool gltf_accessor_is_stored(const Gltf *g, int accessor)
{
    const json_t *object = gltf_item(g, "accessors", accessor);
    return json_object_get(object, "bufferView") || json_object_get(object, "sparse");
}

Status gltf_accessor(double **out, int *count, Gltf *g, int accessor, int components, const char *what)
{
    static const char *const type_name[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    const json_t            *object = gltf_item(g, "accessors", accessor), *extra = json_object_get(object, "sparse");
    const char              *type = json_string_value(json_object_get(object, "type"));
    const int64_t            component = octets_of(object, "componentType", -1), n = octets_of(object, "count", -1);
    const int                size = size_of(component);
    *out = NULL;
    if (!type || strcmp(type, components == 16 ? "MAT4" : type_name[components]) != 0 || size == 0 || n < 1 ||
        n > 3 * (int64_t)import_max_triangles)
        return reader_fails(g->said, STATUS_BAD_VALUE, "%s: accessor %d is wrong, or has more than 24 M elements", what,
                            accessor);
    const bool normalised = json_is_true(json_object_get(object, "normalized")) && component < 5125;
    double    *numbers = calloc((size_t)n * (size_t)components, sizeof *numbers);
    if (!numbers) return STATUS_NO_MEMORY;
    Status status = STATUS_OK;
    if (json_object_get(object, "bufferView")) {
        const int   view = gltf_index(object, "bufferView", json_array_size(json_object_get(g->root, "bufferViews")));
        const char *base = NULL;
        size_t      stride = 0;
        const Elements all = {what, (size_t)size * (size_t)components, (size_t)n, true};
        status = view_at(&base, &stride, g, view, octets_of(object, "byteOffset", 0), &all);
        for (size_t i = 0; i < (size_t)n && status == STATUS_OK; i++)
            for (int k = 0; k < components; k++)
                numbers[i * (size_t)components + (size_t)k] =
                    number_at(base + i * stride + k * size, component, normalised);
    }
    if (status == STATUS_OK && extra)
        status = sparse(numbers, (size_t)n, g, extra, &(Numbers){components, component, normalised, what});
    if (status != STATUS_OK) {
        free(numbers);
        return status;
    }
    *out = numbers;
    *count = (int)n;
    return STATUS_OK;
}

/* ---- extensions: which are read, which do no harm, and what is said of others --------------- */

/* Extensions that a file may require. */
static const char *const read_here[] = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_node_visibility",
                                        "KHR_materials_pbrSpecularGlossiness"};
/* Extensions of pictures: no picture is taken from a model, packed or not. */
static const char *const of_textures[] = {"KHR_texture_basisu", "KHR_texture_transform", "EXT_texture_webp",
                                          "EXT_texture_avif", "MSFT_texture_dds"};
/* Extensions of nodes, meshes and materials that do not concern shape, or that are counted among what is lost. */
static const char *const no_shape[] = {
    "KHR_lights_punctual",      "KHR_materials_variants",
    "KHR_xmp_json_ld",          "MSFT_lod",
    "EXT_mesh_features",        "EXT_structural_metadata",
    "EXT_instance_features",    "EXT_feature_metadata",
    "CESIUM_primitive_outline", "FB_ngon_encoding",
    "KHR_node_hoverability",    "KHR_node_selectability",
    "KHR_audio_emitter",        "EXT_meshopt_compression",
    "KHR_meshopt_compression",  "KHR_draco_mesh_compression"}; /* read where the plain numbers are there too */

#define HAS(list, name) has(list, sizeof list / sizeof *list, name)
static bool has(const char *const *list, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(list[i], name) == 0) return true;
    return false;
}

static const char *remedy(const char *name)
{
    if (strstr(name, "meshopt_compression"))
        return "pack it without (gltfpack without -c) or unpack it (gltf-transform copy)";
    if (strstr(name, "draco")) return "export it without mesh compression";
    if (strncmp(name, "KHR_materials_", 14) == 0) return "it is of looks alone: take it out of extensionsRequired";
    return "export it without";
}

int gltf_index(const json_t *object, const char *key, size_t count)
{
    const json_t *value = json_object_get(object, key);
    return json_is_integer(value) && json_integer_value(value) >= 0 && (size_t)json_integer_value(value) < count
               ? (int)json_integer_value(value)
               : -1;
}

json_t *gltf_item(const Gltf *g, const char *list, int index)
{
    return index < 0 ? NULL : json_array_get(json_object_get(g->root, list), (size_t)index);
}

json_t *gltf_extension(const json_t *object, const char *name)
{
    return json_object_get(json_object_get(object, "extensions"), name);
}

bool gltf_numbers(double *out, bool *wrong, const json_t *object, const char *key, size_t count)
{
    const json_t *list = json_object_get(object, key);
    if (!list) return false;
    bool fine = json_array_size(list) == count;
    for (size_t i = 0; i < count && fine; i++) {
        fine = json_is_number(json_array_get(list, i));
        out[i] = json_number_value(json_array_get(list, i));
    }
    *wrong = *wrong || !fine;
    return fine;
}

/* Names of extensions on the objects of a list and on their members (primitives, targets), each once, with how often it
 * occurs. */
typedef struct Left {
    int kinds;
    struct {
        const char *name;
        int         count;
    } kind[16];
} Left;

static void look_at(Left *left, const json_t *object)
{
    const char *name;
    json_t     *value;
    json_object_foreach(json_object_get(object, "extensions"), name, value)
    {
        if (HAS(read_here, name) || HAS(of_textures, name) || HAS(no_shape, name)) continue;
        int k = 0;
        while (k < left->kinds && strcmp(left->kind[k].name, name) != 0) k++;
        if (k == (int)(sizeof left->kind / sizeof *left->kind)) continue;
        left->kind[k].name = name;
        left->kind[k].count++;
        left->kinds += k == left->kinds;
    }
}

Status gltf_extensions(Gltf *g)
{
    static const char *const lists[] = {"nodes", "meshes", "accessors", "bufferViews", "buffers", "skins", "scenes"};
    size_t                   i, j;
    json_t                  *value, *item;
    Left                     left = {0};
    json_array_foreach(json_object_get(g->root, "extensionsRequired"), i, value)
    {
        const char *name = json_string_value(value);
        if (!name) return reader_fails(g->said, STATUS_BAD_VALUE, "extensionsRequired: an entry is no name");
        if (HAS(of_textures, name))
            reader_warns(g->said, "requires the extension %.80s: no picture is taken from a model, its shape is read",
                         name);
        else if (!HAS(read_here, name))
            return reader_fails(g->said, STATUS_UNSUPPORTED, "requires the extension %.80s, which is not read: %s",
                                name, remedy(name));
    }
    for (size_t l = 0; l < sizeof lists / sizeof *lists; l++)
        json_array_foreach(json_object_get(g->root, lists[l]), i, item)
        {
            look_at(&left, item);
            if (strcmp(lists[l], "meshes") == 0)
                json_array_foreach(json_object_get(item, "primitives"), j, value) look_at(&left, value);
            if (strcmp(lists[l], "nodes") == 0)
                g->scene->lost[LOST_LEVELS_OF_DETAIL] +=
                    (int)json_array_size(json_object_get(gltf_extension(item, "MSFT_lod"), "ids"));
        }
    for (int k = 0; k < left.kinds; k++)
        reader_warns(g->said,
                     "the extension %.80s, on %d of its parts, is not read and left out: compare the shape with "
                     "`pitviper model show`",
                     left.kind[k].name, left.kind[k].count);
    return STATUS_OK;
}

/* A texture's use is `somethingTexture: {index: ...}`, in a material or its extensions. */
static int textures_below(const json_t *object, int depth)
{
    const char *key;
    json_t     *value;
    int         count = 0;
    json_object_foreach((json_t *)(uintptr_t)object, key, value)
    {
        const size_t length = strlen(key);
        if (length >= 7 && strcasecmp(key + length - 7, "texture") == 0)
            count += json_object_get(value, "index") != NULL;
        else if (json_is_object(value) && depth < 4) count += textures_below(value, depth + 1);
    }
    return count;
}

int gltf_textures(const Gltf *g)
{
    size_t  i;
    json_t *material;
    int     count = 0;
    json_array_foreach(json_object_get(g->root, "materials"), i, material) count += textures_below(material, 0);
    return count;
}
