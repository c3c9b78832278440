/* tests/fuzz/fuzz_gltf.c: any octets as a glTF file, text or binary. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "entities/import/reader_private.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

/* A triangle each of quantised, sparse, skinned, morphed and instanced numbers; a strip; GLB. */
#define NUMBERS "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAAECAAECAAECAAAAAA=="
#define HEAD    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1]}],"
#define VIEWS                                                                                                          \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":16,"             \
    "\"byteStride\":4}],"
static const char *const seed[4] = {
    HEAD "\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"nodes\":[{\"mesh\":0,\"scale\":[2,2,2],\"rotation\":[0,"
         "1,0,1],"
         "\"weights\":[0.5]},{\"name\":\"b\",\"children\":[2],\"extensions\":{\"ACME_x\":{}}},{\"mesh\":0,\"skin\":0}],"
         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"JOINTS_0\":2,\"WEIGHTS_0\":2},"
         "\"targets\":[{\"POSITION\":1}],"
         "\"mode\":5,\"material\":0}]}],\"skins\":[{\"joints\":[1,2,1,1]}],"
         "\"materials\":[{\"name\":\"m\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0,0,1],\"baseColorTexture\":{"
         "\"index\":0}}}],"
         "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":1,"
         "\"componentType\":5120,"
         "\"normalized\":true,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5121,\"count\":3,"
         "\"type\":\"VEC4\"}]," VIEWS "\"buffers\":[{\"byteLength\":52,\"uri\":\"data:a;base64," NUMBERS "\"}]}",
    HEAD "\"nodes\":[{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":0,"
         "\"SCALE\":0}}}},"
         "{\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,5,0,0,1],\"extensions\":{\"KHR_node_visibility\":{"
         "\"visible\":false}}}],"
         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":6},{\"attributes\":{"
         "\"POSITION\":0},\"mode\":1}]}],"
         "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":"
         "1,\"indices\":"
         "{\"bufferView\":1,\"componentType\":5121},\"values\":{\"bufferView\":0}}},{\"bufferView\":1,"
         "\"componentType\":5121,\"count\":3,"
         "\"type\":\"SCALAR\"}]," VIEWS "\"buffers\":[{\"byteLength\":52,\"uri\":\"data:a;base64," NUMBERS "\"}]}",
    "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"children\":[0]}],\"meshes\":[{"
    "\"primitives\":[{\"attributes\":"
    "{\"POSITION\":0}}]}],\"accessors\":[{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}]}",
    HEAD "\"nodes\":[{\"mesh\":0},{}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":["
         "{\"bufferView\":0,"
         "\"componentType\":5123,\"count\":3,\"type\":\"VEC3\"}]," VIEWS "\"buffers\":[{\"byteLength\":52}]}",
};

static void word(uint8_t *at, size_t value)
{
    for (int i = 0; i < 4; i++) at[i] = (uint8_t)(value >> 8 * i);
}

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    if (index % 4 != 3) return fuzz_seed_text(out, seed[index % 4]);
    const size_t length = fuzz_seed_text(out + 20, seed[3]);
    memcpy(out, "glTF", 4);
    word(out + 4, 2);
    word(out + 8, 20 + length + 8 + 52);
    word(out + 12, length);
    memcpy(out + 16, "JSON", 4);
    word(out + 20 + length, 52);
    memcpy(out + 24 + length, "BIN\0", 4);
    for (size_t i = 0; i < 52; i++) out[28 + length + i] = (uint8_t)(7 * i);
    return 28 + length + 52;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static ReaderSaid said;
    ReaderFiles       files;
    ImportScene       scene = {0};
    char             *text = malloc(size + 1);
    if (!text) return 0;
    memcpy(text, data, size);
    said = (ReaderSaid){0};
    reader_files(&files, "/nowhere/fuzz.gltf");
    const Status status = import_gltf_text(&scene, &said, &files, text, size);
    if (status == STATUS_OK && !import_scene_is_sound(&scene)) abort();
    if (status != STATUS_OK && status != STATUS_NO_MEMORY && !said.error[0]) abort();
    import_scene_close(&scene);
    free(text);
    return 0;
}
