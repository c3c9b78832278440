/* entities/import/gltf_extensions.c: which extensions of glTF are read, which do no harm, and what is said of others.
 */
#include "entities/import/gltf.h"

#include <stdlib.h>

/* What a required extension may be. */
static const char *const read_here[] = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_node_visibility",
                                        "KHR_materials_pbrSpecularGlossiness"};
/* Of pictures, and no picture is taken from a model, packed or not. */
static const char *const of_textures[] = {"KHR_texture_basisu", "KHR_texture_transform", "EXT_texture_webp",
                                          "EXT_texture_avif", "MSFT_texture_dds"};
/* On nodes, meshes and what they are made of, but not of shape; or counted among what is lost. */
static const char *const no_shape[] = {
    "KHR_lights_punctual",      "KHR_materials_variants",
    "KHR_xmp_json_ld",          "MSFT_lod",
    "EXT_mesh_features",        "EXT_structural_metadata",
    "EXT_instance_features",    "EXT_feature_metadata",
    "CESIUM_primitive_outline", "FB_ngon_encoding",
    "KHR_node_hoverability",    "KHR_node_selectability",
    "KHR_audio_emitter",        "EXT_meshopt_compression",
    "KHR_meshopt_compression",  "KHR_draco_mesh_compression"}; /* where the plain numbers are there too */

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

/* Names of extensions on objects of a list, and of their members (primitives, targets), each once, with how many. */
typedef struct Left {
    int kinds;
    struct {
        const char *name;
        int count;
    } kind[16];
} Left;

static void look_at(Left *left, const json_t *object)
{
    const char *name;
    json_t *value;
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
    size_t i, j;
    json_t *value, *item;
    Left left = {0};
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
    json_t *value;
    int count = 0;
    json_object_foreach((json_t *)(uintptr_t)object, key, value)
    {
        const size_t length = strlen(key);
        if (length >= 7 && strcasecmp(key + length - 7, "texture") == 0)
            count += json_object_get(value, "index") != NULL;
        else if (json_is_object(value) && depth < 4)
            count += textures_below(value, depth + 1);
    }
    return count;
}

int gltf_textures(const Gltf *g)
{
    size_t i;
    json_t *material;
    int count = 0;
    json_array_foreach(json_object_get(g->root, "materials"), i, material) count += textures_below(material, 0);
    return count;
}
