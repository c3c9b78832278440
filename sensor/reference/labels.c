/* sensor/reference/labels.c: what a recogniser is trained on: pairs.jsonl and coco.json. */
#include "sensor/reference/reference.h"

#include "sensor/reference/words.h"

static const ReferenceField pair_fields[] = {
    {"frame", "integer", "", "from 0", "", "number of the frame"},
    {"time_s", "number", "s", "exercise time", "", "instant of the frame"},
    {"seed", "integer", "", "", "", "of the noise, the same in all members"},
    {"removed", "list of strings", "", "site:application:entity", "", "entities that are not in the background"},
    {"frame_sha256", "string", "", "", "", "of the planes with the target, as in truth.jsonl"},
    {"background_sha256", "string", "", "", "", "of the planes without it"},
    {"members", "list of objects", "", "with noise, with; with, without; without, with; without, without", "",
     "the four pictures of each band"},
    {"members[].target", "boolean", "", "", "", "the target is in it"},
    {"members[].noise", "boolean", "", "", "", "the detector's noise is in it"},
    {"members[].truth", "string", "", "file, from the folder of pairs.jsonl", "", "its truth EXR"},
    {"members[].bands", "object", "", "", "", "its pictures"},
    {"members[].bands.BAND", "object", "", "", "when the band was not made", "of one band"},
    {"members[].bands.BAND.radiance", "string", "", "file", "", "its EXR, which holds no noise of a detector"},
    {"members[].bands.BAND.display", "string", "", "file", "with --no-png", "its PNG; radar: without noise too"},
    {"members[].bands.BAND.raw", "string", "", "file", "without a sensor, and in radar", "its counts"},
    {"members[].bands.BAND.level", "list of 2 numbers", "counts of the sensor; else W/(m2 sr)", "black, white",
     "in radar and with --no-png", "what black and white of the display stand for; RGB: of the balanced picture"},
};
static const ReferenceWord words[] = {REFERENCE_WORD_BAND};

const Reference reference_pairs = {
    .topic = "pairs",
    .file  = "pairs.jsonl",
    .title = "each frame with and without its target, with and without noise: a line of JSON a frame",
    .about = "With --pairs target or --pairs all. The files lie in frames/ and raw/ (as without --pairs) and in\n"
             "pairs/clean, pairs/background and pairs/background_clean, each with folders of the same names.",
    .field = REFERENCE_FIELDS(pair_fields),
    .word  = REFERENCE_FIELDS(words),
    .python =
        "import json\n"
        "for line in open('pairs.jsonl'):\n"
        "    pair = json.loads(line)\n"
        "    file = {(m['target'], m['noise']): m['bands']['lwir'] for m in pair['members']}\n"
        "    print('noisy picture', file[True, True]['display'])\n"
        "    print('label: radiance of the target alone =', file[True, False]['radiance'], '-',\n"
        "          file[False, False]['radiance'], 'of', pair['removed'])\n",
};

static const ReferenceField coco_fields[] = {
    {"images", "list of objects", "", "", "", "one a frame and band"},
    {"images[].id", "integer", "", "from 1", "", "number of the image"},
    {"images[].width", "integer", "px", "", "", "columns"},
    {"images[].height", "integer", "px", "", "", "rows"},
    {"images[].file_name", "string", "", "file, from the folder of coco.json", "", "its PNG; with --no-png its EXR"},
    {"images[].band", "string", "", "", "", "BAND"},
    {"images[].frame", "integer", "", "from 0", "", "number of the frame"},
    {"images[].time_s", "number", "s", "exercise time", "", "instant of the frame"},
    {"images[].variant", "string", "", "", "but in the coco.json of a sweep", "the variant's folder"},
    {"annotations", "list of objects", "", "", "", "one a target and image in whose mask it has a pixel"},
    {"annotations[].id", "integer", "", "from 1", "", "number of the annotation"},
    {"annotations[].image_id", "integer", "", "", "", "of images[].id"},
    {"annotations[].category_id", "integer", "", "", "", "of categories[].id"},
    {"annotations[].bbox", "list of 4 integers", "px", "image: left, top, width, height; from 0", "",
     "box of the mask"},
    {"annotations[].area", "integer", "px", "", "", "pixels of the mask"},
    {"annotations[].pixels", "number", "px", "", "", "area seen, parts of pixels too: pixels of truth.jsonl"},
    {"annotations[].iscrowd", "integer", "", "", "",
     "1: below publish.coco_min_pixels or publish.coco_min_visible, for judges to ignore; else 0"},
    {"annotations[].ignore", "integer", "", "", "", "as iscrowd"},
    {"annotations[].segmentation", "object", "", "", "", "the mask: pixels of which most is the target"},
    {"annotations[].segmentation.size", "list of 2 integers", "px", "rows, columns", "", "of the picture"},
    {"annotations[].segmentation.counts", "string", "", "down the columns, the first run is off", "",
     "lengths of runs, off and on in turn, compressed as pycocotools does"},
    {"annotations[].entity", "string", "", "site:application:entity", "", "whose it is"},
    {"annotations[].plane_value", "integer", "", "from 1; 0: none", "", "its value in plane `entity` of the truth EXR"},
    {"annotations[].model", "string", "", "", "", "the model that stands for it, a row of the catalog"},
    {"annotations[].type", "string", "", "kind.domain.country.category.subcategory.specific.extra", "",
     "its entity type"},
    {"annotations[].range_m", "number", "m", "", "", "as in truth.jsonl"},
    {"annotations[].aspect_deg", "number", "deg", "", "", "as in truth.jsonl"},
    {"annotations[].visible_fraction", "number", "", "", "as in truth.jsonl", "as in truth.jsonl"},
    {"categories", "list of objects", "", "", "", "a fixed table, the same for every log and version"},
    {"categories[].id", "integer", "", "from 1", "", "number of the category"},
    {"categories[].name", "string", "", "", "", "tank, apc, truck ...: class of truth.jsonl"},
    {"categories[].supercategory", "string", "", "", "",
     "land, air, sea, space, munition, life, fixed, expendable or other"},
    {"licenses", "list of objects", "", "", "", "empty"},
    {"info", "object", "", "", "", "where it comes from"},
    {"info.description", "string", "", "", "", "`pitviper replay`, or `pitviper replay --sweep`"},
    {"info.version", "string", "", "", "", "of the program"},
    {"info.config_sha256", "string", "", "", "in that of a sweep", "as in run.json"},
    {"info.seed", "integer", "", "", "in that of a sweep", "of all random numbers"},
    {"info.min_pixels", "integer", "px", "", "in that of a sweep", "publish.coco_min_pixels"},
    {"info.min_visible", "number", "", "0 .. 1", "in that of a sweep", "publish.coco_min_visible"},
    {"info.variants", "integer", "", "", "but in that of a sweep", "whose files are joined"},
};

const Reference reference_coco = {
    .topic = "coco",
    .file  = "coco.json",
    .title = "boxes and masks of all targets, as COCO has them",
    .about = "With --coco; written at the end of the run. A sweep has one a variant and one of all in its own folder.",
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
