/* sensor/reference/reference_labels.c: products for training and judging a recogniser, and of many runs: pairs.jsonl,
 * coco.json, answers.jsonl, score.json, the manifest of a sweep, the baseline of a regression. */
#include "sensor/reference/reference.h"

#include "render/frame/planes.h"
#include "sensor/commands/sweep/sweep.h"
#include "sensor/publish/consumers/consume_pairs.h"
#include "sensor/publish/answers/answers.h"
#include "sensor/score/score_fields.h"

static const ReferenceWord words[] = {REFERENCE_WORD_BAND};

const Reference reference_pairs = {
    .topic = "pairs",
    .file = "pairs.jsonl",
    .title = "each frame with and without its target, with and without noise: a line of JSON per frame",
    .about = "With --pairs target or --pairs all. The files lie in frames/ and raw/ (as without --pairs) and in\n"
             "pairs/clean, pairs/background and pairs/background_clean, each with folders of the same names.",
    .table = &pair_fields,
    .word = REFERENCE_FIELDS(words),
    .python = "import json\n"
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
    {"annotations", "list of objects", "", "", "",
     "one per image and target of which something is visible; with publish.coco_clutter also one per thing of clutter"},
    {"annotations[].id", "integer", "", "from 1", "", "number of the annotation"},
    {"annotations[].image_id", "integer", "", "", "", "of images[].id"},
    {"annotations[].category_id", "integer", "", "", "", "of categories[].id"},
    {"annotations[].bbox", "list of 4 integers", "px", "image: left, top, width, height; from 0", "",
     "bounding box of the mask; of an ignore region the box of all pixels that show any part of the target"},
    {"annotations[].bbox_amodal", "list of 4 numbers", "px", "image: left, top, width, height", "of clutter",
     "box of all its vertices, hidden or not, not cropped by the image"},
    {"annotations[].area", "integer", "px", "", "", "number of mask pixels"},
    {"annotations[].pixels", "number", "px", "", "", "visible area with fractions of pixels: pixels of truth.jsonl"},
    {"annotations[].iscrowd", "integer", "", "", "",
     "1: an ignore region, in which a detection of this category is neither right nor wrong; 0: a target to be found"},
    {"annotations[].ignore", "integer", "", "", "", "as iscrowd"},
    {"annotations[].ignored_as", "string", "", "", "of a target to be found, of clutter",
     "why, the first that holds: `no_mask`, it fills no pixel by more than half; `small`, below publish.coco_min_pixels; "
     "`hidden`, below publish.coco_min_visible; `faint`, below publish.coco_min_snr"},
    {"annotations[].segmentation", "object", "", "", "",
     "the mask: pixels mostly covered by the target; of an ignore region all of bbox"},
    {"annotations[].segmentation.size", "list of 2 integers", "px", "rows, columns", "", "size of the image"},
    {"annotations[].segmentation.counts", "string", "", "column by column, the first run is off", "",
     "lengths of runs, off and on in turn, compressed as pycocotools does"},
    {"annotations[].entity", "string", "", "site:application:entity", "of clutter", "the target"},
    {"annotations[].plane_value", "integer", "", "from 1; 0: none", "of clutter",
     "its value in plane `entity` of the truth EXR"},
    {"annotations[].model", "string", "", "", "of clutter", "its model, a row of the catalog"},
    {"annotations[].type", "string", "", "kind.domain.country.category.subcategory.specific.extra", "of clutter",
     "its entity type"},
    {"annotations[].class", "string", "", "", "of a target", "of clutter: clutter[].class of truth.jsonl"},
    {"annotations[].clutter", "string", "", "", "of a target", "clutter[].id of truth.jsonl"},
    {"annotations[].range_m", "number", "m", "", "", "as in truth.jsonl"},
    {"annotations[].aspect_deg", "number", "deg", "", "of clutter", "as in truth.jsonl"},
    {"annotations[].visible_fraction", "number", "", "", "as in truth.jsonl", "as in truth.jsonl"},
    {"annotations[].foliage_fraction", "number", "", "", "as in truth.jsonl", "as in truth.jsonl"},
    {"annotations[].occluded_by", "string", "", "", "as in truth.jsonl", "as in truth.jsonl"},
    {"annotations[].snr", "number", "", "", "as in truth.jsonl", "bands.BAND.snr of truth.jsonl, in the image's band"},
    {"annotations[].contrast", "number", "K, apparent, in mwir and lwir; else ratio", "", "as in truth.jsonl",
     "bands.BAND.contrast_k of truth.jsonl in mwir and lwir, bands.BAND.contrast in optical and radar"},
    {"annotations[].contrast_k", "number", "K, apparent", "", "as in truth.jsonl",
     "bands.BAND.contrast_k of truth.jsonl"},
    {"categories", "list of objects", "", "", "",
     "a fixed table, the same for every log and version; and 200, `clutter`, where it is annotated"},
    {"categories[].id", "integer", "", "from 1", "", "number of the category"},
    {"categories[].name", "string", "", "", "", "tank, apc, truck ...: class of truth.jsonl; or `clutter`"},
    {"categories[].supercategory", "string", "", "", "",
     "land, air, sea, space, munition, life, fixed, expendable, other or clutter"},
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
    .file = "coco.json",
    .title = "boxes and masks of all targets, and ignore regions, in COCO format",
    .about = "With --coco; written at the end of the run. A sweep has one per variant, and one of all variants in its "
             "own folder.",
    .field = REFERENCE_FIELDS(coco_fields),
    .word = REFERENCE_FIELDS(words),
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

const Reference reference_answers = {
    .topic = "answers",
    .file = "answers.jsonl",
    .title = "the answers of a recogniser: a line of JSON per detection",
    .about = "With publish.detections_port (etc/reference/answers.md). The first answer to a band of a frame counts;\n"
             "repeated ones, and all that are refused, are counted in run.json: counters.answers. The lines of an\n"
             "answer, sent back in one datagram, are that answer.",
    .table = &answer_fields,
    .word = REFERENCE_FIELDS(words),
    .python =
        "import json\n"
        "for line in open('answers.jsonl'):\n"
        "    answer = json.loads(line)\n"
        "    if answer['of'] == 0:               # nothing was found\n"
        "        continue\n"
        "    where = answer.get('box_px') or answer['los_deg']\n"
        "    print(answer['frame'], answer['band'], answer['class'], where, answer.get('score'), answer['latency_ms'])\n",
};

static const ReferenceWord score_words[] = {
    REFERENCE_WORD_BAND,
    {"CLASS", "tank, apc, truck ...: class of truth.jsonl", NULL, NULL},
    {"CLUTTER", "car, animal, fire ...: clutter[].class of truth.jsonl", NULL, NULL},
    {"TRUE", "a class of truth.jsonl, or false: where nothing is", NULL, NULL},
    {"ANSWERED", "a class of truth.jsonl, unknown, or missed", NULL, NULL},
    {"WORD", "a recogniser's own word", NULL, NULL},
};

const Reference reference_score = {
    .topic = "score.json",
    .file = "score.json",
    .title = "a recogniser's answers against the truth",
    .about =
        "Of `pitviper score OUT` (etc/reference/score.md), in OUT or where --out says. What a target to be found is,\n"
        "and when an answer names it, is in that page. Bounds are of 95 %, over sequences: hosts, variants of a sweep.",
    .table = &score_fields,
    .word = REFERENCE_FIELDS(score_words),
    .python = "import json\n"
              "score = json.load(open('score.json'))\n"
              "for r in score['recognisers']:\n"
              "    print(r['name'], r['total']['found'], 'of', r['total']['chances'], 'found')\n"
              "    for bin in r['against']['range_m']:\n"
              "        if 'detection' in bin:\n"
              "            rate = bin['detection']\n"
              "            print(bin['from'], bin.get('to'), rate['value'], rate['low'], rate['high'])\n",
};

/* ---- manifest.jsonl and the page of a sweep ------------------------------------------------------ */

static const ReferenceWord sweep_words[] = {
    {"KEY", "a setting's section and key with a dot between, such as weather.visibility_m", NULL, NULL},
};

const Reference reference_manifest = {
    .topic = "manifest",
    .file = "manifest.jsonl",
    .title = "the variants of a sweep: a line of JSON each",
    .about = "Of --sweep FILE. Each variant's line, with status `made`, is also its FOLDER/variant.json: it marks\n"
             "the variant as complete, to be kept by the next run.",
    .table = &variant_fields,
    .word = REFERENCE_FIELDS(sweep_words),
    .python = "import json, os\n"
              "for line in open('manifest.jsonl'):\n"
              "    variant = json.loads(line)\n"
              "    if variant['status'] == 'failed':\n"
              "        print(variant['number'], variant['error'])\n"
              "        continue\n"
              "    truth = [json.loads(l) for l in open(os.path.join(variant['folder'], 'truth.jsonl'))]\n"
              "    print(variant['settings'], variant['frames'], 'frames', len(truth[0]['targets']), 'targets in "
              "the first')\n",
};

static const ReferenceField sheet_fields[] = {
    {"figure", "element", "", "", "", "a variant"},
    {"figure/img", "element", "", "src: PNG as data:, of variants beyond 400 FOLDER/thumbnail.png", "without PNGs",
     "its bands side by side, middle frame of the run; alt: its folder"},
    {"figure/figcaption", "element", "", "", "", "its folder in <b>, then a line per setting"},
};

const Reference reference_sheet = {
    .topic = "sheet",
    .file = "manifest.html",
    .title = "thumbnails of the variants of a sweep",
    .about = "Of --sweep FILE, beside manifest.jsonl, which is machine-readable. FOLDER/thumbnail.png is the image of "
             "a variant.",
    .notation = "Field: element of HTML.",
    .field = REFERENCE_FIELDS(sheet_fields),
    .python = "import html.parser\n"
              "class Sheet(html.parser.HTMLParser):\n"
              "    def handle_starttag(self, tag, attributes):\n"
              "        if tag == 'img':\n"
              "            image = dict(attributes)\n"
              "            print(image['alt'], image['src'][:22], len(image['src']))\n"
              "Sheet().feed(open('manifest.html').read())\n",
};

/* ---- the baseline of a case of `pitviper regress` ------------------------------------------------ */

static bool regress_plane(ReferenceField *out, int i)
{
    static char     path[64], unit[64], about[64];
    const PlaneRow *row = plane_recorded(i);
    if (!row) return false;
    const bool coded = row->type == PLANE_F32, of_band = row->kind != PLANE_TRUTH;
    snprintf(path, sizeof path, "channel frame/%s", row->record);
    if (!coded) *unit = 0;
    else if (row->rounding.bits) snprintf(unit, sizeof unit, "%d bits of mantissa", row->rounding.bits);
    else snprintf(unit, sizeof unit, "1/%.0f%s%s", 1 / row->rounding.step, *row->unit ? " " : "", row->unit);
    if (!coded) snprintf(about, sizeof about, "as %s/%s, not coded", row->group, row->name);
    else if (i == 0) snprintf(about, sizeof about, "coded; as %s/%s of `help exr`", row->group, row->name);
    else strcpy(about, "coded");
    *out = (ReferenceField){path, "uint", unit, coded ? "" : "from 1", row->absent, about};
    if (of_band && (row->rgb || !*row->absent)) out->absent = "when it is not in the bands of the case";
    return true;
}

static const ReferenceField regress_fields[] = {
    {"header frame/frame", "int", "", "from 0", "", "number of the frame"},
    {"header frame/material_names", "string", "", "separated by commas; the first is material 1", "in older baselines",
     "names of the materials, by which material is compared"},
    {"header frame/capDate", "string", "", "UTC", "", "instant of the frame"},
    {"channel profile/bounce_1", "uint", "7 bits of mantissa", "", "", "coded; a row of range bins"},
    {"channel profile/bounce_2", "uint", "7 bits of mantissa", "", "", "coded"},
    {"channel profile/bounce_3", "uint", "7 bits of mantissa", "", "", "coded"},
    {"header profile/frame", "int", "", "from 0", "", "number of the frame"},
    {"header profile/capDate", "string", "", "UTC", "", "instant of the frame"},
    {"header profile/near_m", "double", "m", "", "", "centre of the first range bin"},
    {"header profile/bin_m", "double", "m", "", "", "spacing of the bins"},
};

const Reference reference_regress = {
    .topic = "regress-record",
    .file = "CASE/record/",
    .title = "the baseline of a case of `pitviper regress`: NNNNNN.exr, NNNNNN.profile.exr, truth.jsonl, run.json",
    .about =
        "Written by `pitviper regress --update`. truth.jsonl and run.json are those of the approved run (help "
        "truth,\n"
        "help run.json), the latter without threads and timings_ms. NNNNNN.exr has all planes of a frame, "
        "NNNNNN.profile.exr the range\n"
        "profile, when there is a radar; scores.json, when case.yaml has scores, those of the recogniser's answers (`all`, "
        "`bands`, `ap`, `ap50`).\n"
        "card.md beside record/ lists when and why it changed.",
    .notation = "`channel frame/NAME`, `header frame/NAME`: of NNNNNN.exr; profile/: of NNNNNN.profile.exr. Coded: a "
                "count\n"
                "of steps, less that of the left neighbour, zigzag (0, -1, 1, -2 ... are 0, 1, 2, 3 ...), and again "
                "in\n"
                "the upper 16 bits (exclusive or). The unit is the step: a fixed one, or the upper bits of a float32;\n"
                "2^30 steps are NaN, 2^30 - 1 infinity.",
    .listed = regress_plane,
    .field = REFERENCE_FIELDS(regress_fields),
    .python =
        "import glob, numpy, OpenEXR\n"
        "def plane(path, name, bits=0, step=0):\n"
        "    coded = OpenEXR.File(path, separate_channels=True).channels()[name].pixels\n"
        "    zigzag = coded ^ (coded << numpy.uint32(16))\n"
        "    change = (zigzag >> 1).astype('int64') ^ -(zigzag & 1).astype('int64')\n"
        "    steps = numpy.cumsum(change, axis=1).astype('int32')      # wraps around like the encoder\n"
        "    size = numpy.abs(steps)\n"
        "    value = (size.astype('uint32') << numpy.uint32(23 - bits)).view('float32') if bits else size * step\n"
        "    value = numpy.where(size == 2**30 - 1, numpy.inf, value)\n"
        "    value = numpy.where(size == 2**30, numpy.nan, value)\n"
        "    return numpy.where(steps < 0, -value, value)\n"
        "for path in sorted(glob.glob('record/??????.exr')):\n"
        "    print(path, plane(path, 'lwir.Y', bits=11).mean(), 'W/(m2 sr);',\n"
        "          numpy.nanmax(plane(path, 'temp_k', step=1 / 32)), 'K at most')\n",
};
