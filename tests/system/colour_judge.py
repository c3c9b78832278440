"""Displayed colours against colour-science: the 99 test surfaces of CIE 224:2017 and the ColorChecker under D65, through the
bands and the coefficients of sensor/detector/display_values.c. Prints a row a set: how many, CIEDE2000's mean, 95th percentile
and largest; then how far tests/sensor/colour_spectra.h is off, largest: bands, L* a* b*, linear sRGB, CIEDE2000."""
import re
import sys
import warnings

import numpy as np

warnings.filterwarnings('ignore')
sys.path.insert(0, 'etc/colour/make')
sys.dont_write_bytecode = True
import correction as c  # noqa: E402
from colour import delta_E  # noqa: E402
from colour.characterisation import apply_matrix_colour_correction_Finlayson2015 as root_polynomial  # noqa: E402


def numbers(text):
    return [float(x) for x in re.findall(r'-?\d+(?:\.\d+)?', text)]


def after(path, name):
    with open(path, encoding='ascii') as file:
        return re.search(re.escape(name) + r' = \{(.*?)\n?\};', file.read(), re.S).group(1)


of_term = np.array(numbers(after('sensor/detector/display_values.c', 'correction[3][6]'))).reshape(3, 6)
print('sums', np.abs(of_term.sum(axis=1) - 1).max())


def shown(bands):
    return root_polynomial(bands, of_term, degree=2, root_polynomial_expansion=True)


surfaces = c.test_surfaces()
for name, spectra in ('surfaces', surfaces), ('checker', c.checker()), ('materials', c.materials()), ('sky', c.sky()):
    rgb = c.on_screen(shown(c.bands(spectra, c.EDGES_NM)))
    apart = delta_E(c.lab_of_spectra(spectra), c.lab_of_rgb(rgb), method='CIE 2000')
    print(name, len(apart), apart.mean(), np.percentile(apart, 95), apart.max())

table = np.array(numbers(after('tests/sensor/colour_spectra.h', 'surface[surface_count]'))).reshape(-1, 11)
own = surfaces[table[:, 0].astype(int) - 1]
rgb = shown(table[:, 1:4])
apart = delta_E(table[:, 4:7], c.lab_of_rgb(c.on_screen(rgb)), method='CIE 2000')
print('table', len(table), *[np.abs(x).max() for x in (
    c.bands(own, c.EDGES_NM) - table[:, 1:4], c.lab_of_spectra(own) - table[:, 4:7], rgb - table[:, 7:10], apart - table[:, 10])])
