/* sensor/reference/regress.c: the baseline of a case of `pitviper regress`. */
#include "sensor/reference/reference.h"

#define STEP_OF "when it is not in the bands of the case"

static const ReferenceField fields[] = {
    {"channel frame/range_m", "uint", "16 bits of mantissa", "", "", "coded; as truth/range_m of `help exr`"},
    {"channel frame/entity", "uint", "", "from 1", "", "as truth/entity, not coded"},
    {"channel frame/part", "uint", "", "from 1", "", "as truth/part, not coded"},
    {"channel frame/material", "uint", "", "from 1", "", "as truth/material, not coded"},
    {"channel frame/temp_k", "uint", "1/32 K", "", "", "coded"},
    {"channel frame/nx", "uint", "1/512", "", "", "coded"},
    {"channel frame/ny", "uint", "1/512", "", "", "coded"},
    {"channel frame/nz", "uint", "1/512", "", "", "coded"},
    {"channel frame/optical.R", "uint", "7 bits of mantissa", "", STEP_OF, "coded"},
    {"channel frame/optical.G", "uint", "7 bits of mantissa", "", STEP_OF, "coded"},
    {"channel frame/optical.B", "uint", "7 bits of mantissa", "", STEP_OF, "coded"},
    {"channel frame/optical.Y", "uint", "7 bits of mantissa", "", "with sensor.optical rgb", "coded"},
    {"channel frame/mwir.Y", "uint", "10 bits of mantissa", "", STEP_OF, "coded"},
    {"channel frame/lwir.Y", "uint", "11 bits of mantissa", "", STEP_OF, "coded"},
    {"channel frame/radar.Y", "uint", "7 bits of mantissa", "", STEP_OF, "coded"},
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
    .file  = "CASE/record/",
    .title = "the baseline of a case of `pitviper regress`: NNNNNN.exr, NNNNNN.profile.exr, truth.jsonl, run.json",
    .about = "Written by `pitviper regress --update`. truth.jsonl and run.json are those of the approved run (help "
             "truth,\n"
             "help run.json), the latter without threads and timings_ms. NNNNNN.exr has all planes of a frame, "
             "NNNNNN.profile.exr the range\n"
             "profile, when there is a radar. card.md beside record/ lists when and why it changed.",
    .notation = "`channel frame/NAME`, `header frame/NAME`: of NNNNNN.exr; profile/: of NNNNNN.profile.exr. Coded: a "
                "count\n"
                "of steps, less that of the left neighbour, zigzag (0, -1, 1, -2 ... are 0, 1, 2, 3 ...), and again "
                "in\n"
                "the upper 16 bits (exclusive or). The unit is the step: a fixed one, or the upper bits of a float32;\n"
                "2^30 steps are NaN, 2^30 - 1 infinity.",
    .field = REFERENCE_FIELDS(fields),
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
