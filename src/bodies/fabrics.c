/* The numbers of fabrics. One of a kind differs from the next by a factor of two or three; each number says what it is:
 *
 *   measured   of one cloth, by somebody who published it
 *   typical    the middle of what cloths of that sort have in the literature on the Kawabata system (KES-F)
 *   worked out from a thickness h and Young's modulus E: stretch E h, shear E h / 2 (1 + nu), bend E h^3 / 12 (1 - nu^2)
 *
 * KES-F has units of its own: bending of 1 gf cm2/cm is 9.81e-5 N m, shear of 1 gf/(cm degree) is 56.2 N/m, and the
 * extension EMT is that under 500 gf/cm = 490 N/m, so that the sheet's stiffness there, as a secant, is 490 N/m / EMT.
 * A cloth's shear.stiffness is its shear modulus: of two diagonals a cell, each with the area of two cells, the
 * energy is shear.stiffness gamma^2 / 2 a square metre. Warp and weft differ in truth; here is their mean.
 *
 * Thickness is that under next to no load (KES-F: T0, at 0.5 gf/cm2), of what it is worked out from where that has one.
 * Friction is of cloth on cloth of its like, which depends on finish, direction and load by a factor of two [F]: all typical.
 *
 *   [W]  Wang, O'Brien, Ramamoorthi: Data-driven elastic models for cloth. ACM Trans. Graph. 30(4), 2011; the numbers that
 *        come with ARCSim (Narain, Samii, O'Brien 2012), materials/11oz-black-denim.json and paper.json
 *   [D]  Regenerated cellulose-based denim fabric for tropical regions. J. Textiles 2016, 4614168, table 5: six denims, KES-F
 *   [K]  Kawabata: The standardization and analysis of hand evaluation, 2nd ed., Osaka 1980, and what followed it
 *   [F]  Das, Kothari, Vandana: A study on frictional characteristics of woven fabrics. AUTEX Res. J. 5(3), 2005, and what it
 *        names; paper: TAPPI T 549; rubber: [G]
 *   [G]  Gent: Engineering with rubber, 3rd ed., Hanser 2012 */
#include "bodies/fabrics.h"

#include <math.h>

#define AS_IT_IS NAN

static const char *const names[] = {"density",        "stretch.stiffness", "shear.stiffness", "bend.rigidity",
                                    "stretch.tether", "contact.thickness", "contact.friction"};
enum { NAMES = sizeof names / sizeof *names };

static const double values[][NAMES] = {
    /* cotton, a shirting. Typical [K]: 100 to 140 g/m2, EMT 2 to 5 %, G 0.7 to 1.5, B 0.04 to 0.1, T0 0.3 to 0.6 mm */
    {0.12, 1.6e4, 56, 7e-6, AS_IT_IS, 4.5e-4, 0.4},
    /* silk, a light plain weave. Typical [K]: 40 to 90 g/m2, EMT 3 to 6 %, G 0.2 to 0.5, B 0.01 to 0.05, T0 0.15 to 0.35 mm */
    {0.065, 1.2e4, 17, 3e-6, AS_IT_IS, 2.5e-4, 0.25},
    /* denim. Measured: 0.324 kg/m2 and B 6.4e-5 N m along the warp (9.7e-5 along the weft) [W]; mean of six: EMT 5.2 %, G 1.96
     * [D], whose B is 0.14 to 0.23, 1.4e-5 to 2.2e-5 N m, of another fibre. At the smallest loads [W] has a tenth of the stretch.
     * Typical: T0 0.7 to 1.1 mm */
    {0.324, 9.4e3, 110, 6.4e-5, AS_IT_IS, 9e-4, 0.45},
    /* wool, a worsted suiting. Typical [K]: 200 to 300 g/m2, EMT 4 to 8 %, G 0.4 to 1, B 0.05 to 0.2, T0 0.5 to 0.8 mm */
    {0.26, 8.2e3, 37, 1.1e-5, AS_IT_IS, 6e-4, 0.35},
    /* felt of 1 mm. Worked out, from what is no more than an order of magnitude: 200 kg/m3, E 3 MPa, nu 0.3 */
    {0.2, 3e3, 1.15e3, 2.7e-4, AS_IT_IS, 1e-3, 0.4},
    /* rubber, a gum sheet of 0.5 mm. Worked out from [G]: 930 kg/m3, E 1.5 MPa (1 to 5), nu 0.5. It stretches: no tethers */
    {0.465, 750, 250, 2.1e-5, INFINITY, 5e-4, 1},
    /* paper, for copies: 80 g/m2 (ISO 536); h 0.1 mm, E 5 GPa [W], nu 0.3 */
    {0.08, 5e5, 1.9e5, 4.6e-4, AS_IT_IS, 1e-4, 0.4},
};

const sk_presets sk_fabrics = {SK_FABRIC_FIELD, names, NAMES, values[0]};
