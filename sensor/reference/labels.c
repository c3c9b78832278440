/* sensor/reference/labels.c: products for training and judging a recogniser: pairs.jsonl, coco.json, answers.jsonl. */
#include "sensor/reference/reference.h"

#include "sensor/reference/words.h"

static const ReferenceField pair_fields[] = {
    {"frame", "integer", "", "from 0", "", "number of the frame"},
    {"time_s", "number", "s", "exercise time", "", "instant of the frame"},
    {"seed", "integer", "", "", "", "seed of the noise, the same in all members"},
    {"removed", "list of strings", "", "site:application:entity", "", "entities removed from the background"},
    {"frame_sha256", "string", "", "", "", "SHA-256 of the planes with the target, as in truth.jsonl"},
    {"background_sha256", "string", "", "", "", "SHA-256 of the planes without it"},
    {"members", "list of objects", "", "with noise, with; with, without; without, with; without, without", "",
     "the four images of each band"},
    {"members[].target", "boolean", "", "", "", "with the target"},
    {"members[].noise", "boolean", "", "", "", "with the detector's noise"},
    {"members[].truth", "string", "", "file, from the folder of pairs.jsonl", "", "its truth EXR"},
    {"members[].bands", "object", "", "", "", "its images"},
    {"members[].bands.BAND", "object", "", "", "when the band was not rendered", "of one band"},
    {"members[].bands.BAND.radiance", "string", "", "file", "", "its EXR, always without detector noise"},
    {"members[].bands.BAND.display", "string", "", "file", "with --no-png", "its PNG; radar: without noise too"},
    {"members[].bands.BAND.raw", "string", "", "file", "without a sensor, and in radar", "its counts"},
    {"members[].bands.BAND.level", "list of 2 numbers", "counts of the sensor; else W/(m2 sr)", "black, white",
     "in radar and with --no-png", "values shown as black and white; RGB: after white balance"},
};
static const ReferenceWord words[] = {REFERENCE_WORD_BAND};

const Reference reference_pairs = {
    .topic = "pairs",
    .file  = "pairs.jsonl",
    .title = "each frame with and without its target, with and without noise: a line of JSON per frame",
    .about = "With --pairs target or --pairs all. The files lie in frames/ and raw/ (as without --pairs) and in\n"
             "pairs/clean, pairs/background and pairs/background_clean, each with folders of the same names.",
    .field = REFERENCE_FIELDS(pair_fields),
    .word  = REFERENCE_FIELDS(words),
    .python =
        "import json\n"
        "for line in open('pairs.jsonl'):\n"
        "    pair = json.loads(line)\n"
        "    file = {(m['target'], m['noise']): m['bands']['lwir'] for m in pair['members']}\n"
        "    print('noisy image', file[True, True]['display'])\n"
        "    print('label: radiance of the target alone =', file[True, False]['radiance'], '-',\n"
        "          file[False, False]['radiance'], 'of', pair['removed'])\n",
};

static const ReferenceField coco_fields[] = {
    {"images", "list of objects", "", "", "", "one per frame and band"},
    {"images[].id", "integer", "", "from 1", "", "number of the image"},
    {"images[].width", "integer", "px", "", "", "columns"},
    {"images[].height", "integer", "px", "", "", "rows"},
    {"images[].file_name", "string", "", "file, from the folder of coco.json", "", "its PNG; with --no-png its EXR"},
    {"images[].band", "string", "", "", "", "BAND"},
    {"images[].frame", "integer", "", "from 0", "", "number of the frame"},
    {"images[].time_s", "number", "s", "exercise time", "", "instant of the frame"},
    {"images[].variant", "string", "", "", "except in the coco.json of a sweep", "the variant's folder"},
    {"annotations", "list of objects", "", "", "", "one per image and target of which something is visible"},
    {"annotations[].id", "integer", "", "from 1", "", "number of the annotation"},
    {"annotations[].image_id", "integer", "", "", "", "of images[].id"},
    {"annotations[].category_id", "integer", "", "", "", "of categories[].id"},
    {"annotations[].bbox", "list of 4 integers", "px", "image: left, top, width, height; from 0", "",
     "bounding box of the mask; of an ignore region the box of all pixels that show any part of the target"},
    {"annotations[].bbox_amodal", "list of 4 numbers", "px", "image: left, top, width, height", "",
     "box of all its vertices, hidden or not, not cropped by the image"},
    {"annotations[].area", "integer", "px", "", "", "number of mask pixels"},
    {"annotations[].pixels", "number", "px", "", "", "visible area with fractions of pixels: pixels of truth.jsonl"},
    {"annotations[].iscrowd", "integer", "", "", "",
     "1: an ignore region, in which a detection of this category is neither right nor wrong; 0: a target to be found"},
    {"annotations[].ignore", "integer", "", "", "", "as iscrowd"},
    {"annotations[].ignored_as", "string", "", "", "of a target to be found",
     "why, the first that holds: `no_mask`, it fills no pixel by more than half; `small`, below publish.coco_min_pixels; "
     "`hidden`, below publish.coco_min_visible; `faint`, below publish.coco_min_snr"},
    {"annotations[].segmentation", "object", "", "", "",
     "the mask: pixels mostly covered by the target; of an ignore region all of bbox"},
    {"annotations[].segmentation.size", "list of 2 integers", "px", "rows, columns", "", "size of the image"},
    {"annotations[].segmentation.counts", "string", "", "column by column, the first run is off", "",
     "lengths of runs, off and on in turn, compressed as pycocotools does"},
    {"annotations[].entity", "string", "", "site:application:entity", "", "the target"},
    {"annotations[].plane_value", "integer", "", "from 1; 0: none", "", "its value in plane `entity` of the truth EXR"},
    {"annotations[].model", "string", "", "", "", "its model, a row of the catalog"},
    {"annotations[].type", "string", "", "kind.domain.country.category.subcategory.specific.extra", "",
     "its entity type"},
    {"annotations[].range_m", "number", "m", "", "", "as in truth.jsonl"},
    {"annotations[].aspect_deg", "number", "deg", "", "", "as in truth.jsonl"},
    {"annotations[].visible_fraction", "number", "", "", "as in truth.jsonl", "as in truth.jsonl"},
    {"annotations[].foliage_fraction", "number", "", "", "as in truth.jsonl", "as in truth.jsonl"},
    {"annotations[].occluded_by", "string", "", "", "as in truth.jsonl", "as in truth.jsonl"},
    {"annotations[].snr", "number", "", "", "as in truth.jsonl", "bands.BAND.snr of truth.jsonl, in the image's band"},
    {"annotations[].contrast", "number", "K, apparent, in mwir and lwir; else ratio", "", "as in truth.jsonl",
     "bands.BAND.contrast_k of truth.jsonl in mwir and lwir, bands.BAND.contrast in optical and radar"},
    {"annotations[].contrast_k", "number", "K, apparent", "", "as in truth.jsonl", "bands.BAND.contrast_k of truth.jsonl"},
    {"categories", "list of objects", "", "", "", "a fixed table, the same for every log and version"},
    {"categories[].id", "integer", "", "from 1", "", "number of the category"},
    {"categories[].name", "string", "", "", "", "tank, apc, truck ...: class of truth.jsonl"},
    {"categories[].supercategory", "string", "", "", "",
     "land, air, sea, space, munition, life, fixed, expendable or other"},
    {"licenses", "list of objects", "", "", "", "empty"},
    {"info", "object", "", "", "", "origin of the file"},
    {"info.description", "string", "", "", "", "`pitviper replay`, or `pitviper replay --sweep`"},
    {"info.version", "string", "", "", "", "of the program"},
    {"info.config_sha256", "string", "", "", "in that of a sweep", "as in run.json"},
    {"info.seed", "integer", "", "", "in that of a sweep", "of all random numbers"},
    {"info.min_pixels", "integer", "px", "", "in that of a sweep", "publish.coco_min_pixels"},
    {"info.min_visible", "number", "", "0 .. 1", "in that of a sweep", "publish.coco_min_visible"},
    {"info.min_snr", "number", "", "", "in that of a sweep", "publish.coco_min_snr"},
    {"info.variants", "integer", "", "", "except in that of a sweep", "number of variants joined"},
};

const Reference reference_coco = {
    .topic = "coco",
    .file  = "coco.json",
    .title = "boxes and masks of all targets, and ignore regions, in COCO format",
    .about = "With --coco; written at the end of the run. A sweep has one per variant, and one of all variants in its "
             "own folder.",
    .field = REFERENCE_FIELDS(coco_fields),
    .word  = REFERENCE_FIELDS(words),
    .python =
        "import json\n"
        "coco = json.load(open('coco.json'))\n"
        "name = {c['id']: c['name'] for c in coco['categories']}\n"
        "image = {i['id']: i for i in coco['images']}\n"
        "print(len(image), 'images,', len(coco['annotations']), 'annotations')\n"
        "for a in coco['annotations']:\n"
        "    left, top, width, height = a['bbox']\n"
        "    print(image[a['image_id']]['file_name'], name[a['category_id']], (left, top, width, height), a['area'])\n"
        "# with pycocotools: COCO('coco.json').annToMask(a) is the mask, [row][column]\n",
};

static const ReferenceField answer_fields[] = {
    {"frame", "integer", "", "from 0", "", "number of the frame that was answered"},
    {"band", "string", "", "", "", "BAND that was answered"},
    {"time_s", "number", "s", "exercise time", "", "instant of that frame"},
    {"answer", "integer", "", "from 1", "", "number of the detection among those of the answer; 0: it found nothing"},
    {"of", "integer", "", "", "", "detections of the answer: so many lines belong together"},
    {"class", "string", "", "", "when nothing was found", "the recogniser's own word, at most 31 characters"},
    {"box_px", "list of 4 numbers", "px", "image: left, top, right, bottom; from 0, the last two beyond it",
     "when nothing was found", "bounding box"},
    {"score", "number", "", "0 .. 1", "when nothing was found", "confidence"},
    {"track", "integer", "", "", "when the recogniser gave none", "the same number for the same object in later frames"},
    {"latency_ms", "number", "ms", "", "", "from the end of the frame's rendering until the answer was received"},
    {"late", "boolean", "", "", "", "a newer frame of the band was answered before: not in metadata"},
};

const Reference reference_answers = {
    .topic = "answers",
    .file  = "answers.jsonl",
    .title = "the answers of a recogniser: a line of JSON per detection",
    .about = "With publish.detections_port (etc/reference/memory.md). One answer counts for a frame and band, the first; "
             "repeated ones,\n"
             "and all that are refused, are counted in run.json: counters.answers.",
    .field = REFERENCE_FIELDS(answer_fields),
    .word  = REFERENCE_FIELDS(words),
    .python =
        "import json\n"
        "for line in open('answers.jsonl'):\n"
        "    answer = json.loads(line)\n"
        "    if answer['of'] == 0:               # nothing was found\n"
        "        continue\n"
        "    print(answer['frame'], answer['band'], answer['class'], answer['box_px'], answer['score'], answer['latency_ms'])\n",
};
