/* tests/fuzz/fuzz_coco_truth.c: any octets as the coco.json of a run that is scored. Without a fuzzer run_corpus.c
 * drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/score/coco_truth.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

static const char *const seed[] = {
    "{\"images\":[\n{\"id\":3,\"width\":64,\"height\":48,\"file_name\":\"x\",\"band\":\"lwir\",\"frame\":0},\n"
    "{\"id\":7,\"band\":\"lwir\",\"frame\":1}],\n\"annotations\":[{\"id\":1,\"image_id\":7,\"category_id\":2,"
    "\"bbox\":[1,2,3,4.5],\"iscrowd\":1,\"entity\":\"1:2:3\",\"segmentation\":{\"counts\":\"]}0\\\"\"}}],"
    "\"categories\":[{\"id\":1}],\"licenses\":[],\"info\":{\"version\":\"1\"}}",
    "{\"info\":5,\"annotations\":[],\"images\":[{\"id\":1,\"band\":\"mwir\",\"frame\":9,\"variant\":\"v1\"}]}",
};

size_t fuzz_seed(uint8_t *out, uint32_t index) { return fuzz_seed_text(out, seed[index % 2]); }

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    CocoTruth  coco = {0};
    JsonStream stream;
    FILE      *file = size > 0 ? fmemopen((void *)(uintptr_t)data, size, "r") : NULL;
    if (!file) return 0;
    log_set_level((LogLevel)(LOG_ERROR + 1));
    json_stream_of(&stream, file, "fuzz", 1 << 16);
    const Status status = coco_truth_read_stream(&coco, &stream, true);
    json_stream_close(&stream);
    if (status != STATUS_OK && (coco.count || coco.images.count)) abort();
    for (size_t i = 0; i < coco.images.count; i++) {
        const CocoImage *image = &coco.images.image[i];
        if (coco_image(&coco.images, image->id) != image || image->band >= BAND_COUNT || image->frame < 0) abort();
        if (image->variant >= coco.images.names) abort();
    }
    for (size_t i = 0; i < coco.count; i++) {
        const CocoTarget *t = &coco.target[i];
        size_t            count;
        if (!(t->box[2] >= 0 && t->box[3] >= 0) || t->class_number < 1 || !coco_image(&coco.images, t->image)) abort();
        const CocoTarget *first = coco_targets_of(&count, &coco, t->frame, (Band)t->band);
        if (t < first || t >= first + count) abort();
    }
    coco_truth_free(&coco);
    return 0;
}
