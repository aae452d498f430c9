"""Coefficients of Runge-Kutta-Nystrom methods, and how their stages come by velocities.

Sources.  RKN8(6)9FM and RKN12(10)17M: J. R. Dormand, M. E. A. El-Mikkawy, P. J. Prince, High-order
embedded Runge-Kutta-Nystrom formulae, IMA J. Numer. Anal. 7 (1987) 423; their rational numbers,
rounded.  Both have b_i = v_i (1 - c_i), for the weights of the embedded formulae too.
"""

from typing import NamedTuple

import numpy as np

from tribo.integrators.tableaux import stages


class Nystrom(NamedTuple):
    """f_i at t + c_i h from q + c_i h v + h^2 sum_j a_ij f_j, weights, and an error estimate.

    q + h v + h^2 sum_i b_i f_i and v + h sum_i v_i f_i end the step.
    """

    a: np.ndarray  # (stages, stages), strictly lower triangular
    b: np.ndarray  # (stages,) of places
    v: np.ndarray  # (stages,) of velocities and accounts
    c: np.ndarray  # (stages,)
    r: np.ndarray  # (stages, stages): velocities at the stages are v + h sum_j r_ij f_j
    booked: np.ndarray  # the stages, but for the first, whose powers count
    eb: np.ndarray  # (stages,) weights of the error of places
    ev: np.ndarray  # (stages + 1,) of velocities and accounts; the last at the end of the step
    order: float  # of the error estimate as a power of h


def stage_velocities(v: np.ndarray, c: np.ndarray, matched: int, weighed: int) -> np.ndarray:
    """The matrix r (stages, stages) by which the ledger has the order p of the method.

    It is the smallest one supported on the stages whose weight v_i is not zero, for which

        sum_j r_ij P(c_j)      = int_0^c_i P        for polynomials P of degrees < `matched`,
        sum_i v_i P(c_i) r_ij  = v_j int_c_j^1 P    for polynomials P of degrees < `weighed`.

    A power is linear in the velocity.  Let places at those stages, and so the forces there, be
    right but for O(h^m).  The first set keeps the errors of velocities to O(h^(matched + 1)) and
    to those that come from the forces, of O(h^(m + 1)).  Under the second set both enter the ledger
    as errors of forces enter the end of the step, where the method's own conditions of order
    cancel them.  The sets are compatible if `matched` + `weighed` is at most p; they suffice if
    that is at least p - 1, and `weighed` at least p - 1 - m.  (They are J. C. Butcher's C and D,
    Math. Comput. 18 (1964) 50.)
    """
    live = np.flatnonzero(v)
    n = live.size
    weights, nodes = v[live], c[live]
    upper, whole = _integrals(nodes, max(matched, weighed))
    values = np.polynomial.legendre.legvander(2.0 * nodes - 1.0, max(matched, weighed))
    one = np.eye(n)
    rows = [np.kron(one, values[:, k]) for k in range(matched)]
    right = [upper[:, k] for k in range(matched)]
    rows += [np.kron(weights * values[:, k], one) for k in range(weighed)]
    right += [weights * (whole[k] - upper[:, k]) for k in range(weighed)]
    rows.append(np.kron(one[:1], one))  # velocities at the start are known
    right.append(np.zeros(n))
    found, *_ = np.linalg.lstsq(np.concatenate(rows), np.concatenate(right), rcond=1e-10)
    r = np.zeros((c.size, c.size))
    r[np.ix_(live, live)] = found.reshape(n, n)
    return r


def _integrals(x: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Integrals from 0 to x, and to 1, of the first Legendre polynomials on (0, 1)."""
    p = np.polynomial.legendre.legvander(2.0 * x - 1.0, count + 1)
    upper = np.empty((x.size, count))
    upper[:, 0] = x
    for k in range(1, count):
        upper[:, k] = (p[:, k + 1] - p[:, k - 1]) / (2 * (2 * k + 1))
    return upper, np.eye(count)[0]


def _nystrom(
    a: np.ndarray,
    v: np.ndarray,
    c: np.ndarray,
    error: np.ndarray,
    order: float,
    velocities: tuple[int, int],
) -> Nystrom:
    stages = c.size
    counts = (v != 0.0) | (error[:stages] != 0.0)
    return Nystrom(
        a=a,
        b=v * (1.0 - c),
        v=v,
        c=c,
        r=stage_velocities(v, c, *velocities),
        booked=np.flatnonzero(counts)[1:],
        eb=error[:stages] * (1.0 - c),
        ev=error,
        order=order,
    )


_C8 = np.array([0.0, 0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0])
_A8 = stages(
    {},
    {0: 0.00125},
    {0: 0.0016666666666666668, 1: 0.0033333333333333335},
    {0: 0.045, 1: -0.09, 2: 0.09},
    {0: -0.3379798532571243, 1: 0.8611516478170984, 2: -0.48613644655235316, 3: 0.0879646519923791},
    {
        0: 0.7461462641043086,
        1: -1.804347430246737,
        2: 1.2761518285888953,
        3: -0.031220932716737166,
        4: 0.05827027027027027,
    },
    {
        0: -1.2551623461807584,
        1: 3.257463187064823,
        2: -2.068866619575089,
        3: 0.4206478455603251,
        4: -0.018382978723404254,
        5: 0.06930091185410335,
    },
    {
        0: 3.772901830095941,
        1: -9.669613121677195,
        2: 6.7991544547851674,
        3: -0.8490343907823893,
        4: 0.4671734865470852,
        5: -0.04939742152466368,
        6: 0.028815162556053812,
    },
)
_V8 = np.array(
    [
        0.028092718568909044,
        0.0,
        0.1618992504409171,
        0.2184901738473167,
        0.18303571428571427,
        0.2184901738473167,
        0.1618992504409171,
        0.028092718568909044,
    ]
)
_E8 = np.array(
    [
        -0.044557986852984274,
        0.0,
        0.12183824530112887,
        -0.2088655633733638,
        0.2631706098504384,
        -0.2088655633733638,
        0.12183824530112887,
        0.10544201314701572,
        -0.15,
    ]
)

RKN8 = _nystrom(_A8, _V8, _C8, _E8, 7.0, (5, 3))

_C12 = np.array(
    [
        0.0,
        0.02,
        0.04,
        0.1,
        0.13333333333333333,
        0.16,
        0.05,
        0.2,
        0.25,
        0.3333333333333333,
        0.5,
        0.5555555555555556,
        0.75,
        0.8571428571428571,
        0.9452162222720143,
        1.0,
        1.0,
    ]
)
_A12 = stages(
    {},
    {0: 0.0002},
    {0: 0.0002666666666666667, 1: 0.0005333333333333334},
    {0: 0.002916666666666667, 1: -0.004166666666666667, 2: 0.00625},
    {0: 0.0016460905349794238, 2: 0.0054869684499314125, 3: 0.0017558299039780521},
    {0: 0.0019456, 2: 0.007151746031746032, 3: 0.0029127111111111113, 4: 0.0007899428571428571},
    {
        0: 0.00056640625,
        2: 0.0008809730489417989,
        3: -0.0004369212962962963,
        4: 0.00033900669642857143,
        5: -9.946469907407407e-05,
    },
    {
        0: 0.0030833333333333333,
        3: 0.0017777777777777779,
        4: 0.0027,
        5: 0.0015782828282828283,
        6: 0.01086060606060606,
    },
    {
        0: 0.00365183937480113,
        2: 0.003965171714072343,
        3: 0.0031972582629306284,
        4: 0.008221467306855435,
        5: -0.0013130926959572379,
        6: 0.009771586968064868,
        7: 0.003755769069232834,
    },
    {
        0: 0.003707241068718501,
        2: 0.005082045854555286,
        3: 0.001174708002175412,
        4: -0.021147629915126993,
        5: 0.06010463698107881,
        6: 0.02010573476850619,
        7: -0.02835075012293358,
        8: 0.014879568918581932,
    },
    {
        0: 0.03512537656073344,
        2: -0.008615749195138479,
        3: -0.005791448051007917,
        4: 1.945554823782616,
        5: -3.4351238674565137,
        6: -0.10930701107475221,
        7: 2.3496383118995166,
        8: -0.7560094086870229,
        9: 0.10952897222156927,
    },
    {
        0: 0.020527792537482496,
        2: -0.00728644676448018,
        3: -0.0021153556079618403,
        4: 0.9275807968723522,
        5: -1.6522824844257367,
        6: -0.02107956300568657,
        7: 1.2065364326207872,
        8: -0.4137144770010661,
        9: 0.09079873982809654,
        10: 0.005355552600533985,
    },
    {
        0: -0.14324078875545515,
        2: 0.012528703773091817,
        3: 0.006826019163969827,
        4: -4.799555395574387,
        5: 5.6986250439519415,
        6: 0.7553430369523645,
        7: -0.12755487858281084,
        8: -1.9605926051117384,
        9: 0.9185609056635262,
        10: -0.23880085505284432,
        11: 0.15911081357234216,
    },
    {
        0: 0.8045019205520489,
        2: -0.016658527067011247,
        3: -0.021415834042629735,
        4: 16.827235928962466,
        5: -11.172835357176098,
        6: -3.377159297226324,
        7: -15.243326655360846,
        8: 17.179835738215417,
        9: -5.437719239823995,
        10: 1.3878671618364655,
        11: -0.5925827732652812,
        12: 0.029603873171297354,
    },
    {
        0: -0.913296766697358,
        2: 0.0024112725757805178,
        3: 0.01765812269386174,
        4: -14.851649779720384,
        5: 2.1589708670045757,
        6: 3.99791558311788,
        7: 28.434151800232232,
        8: -25.2593643549416,
        9: 7.733878542362238,
        10: -1.8913028948478674,
        11: 1.0014845070224718,
        12: 0.004641199599109052,
        13: 0.011218755022148957,
    },
    {
        0: -0.27519629720559396,
        2: 0.03661188877915492,
        3: 0.009789519688231562,
        4: -12.293062345886211,
        5: 14.207226453937903,
        6: 1.5866476906789537,
        7: 2.4577735327595946,
        8: -8.935193694403273,
        9: 4.373672731613407,
        10: -1.8347181765449492,
        11: 1.1592085289061491,
        12: -0.017290253165383924,
        13: 0.019325977904460768,
        14: 0.005204442937554993,
    },
    {
        0: 1.3076391847404059,
        2: 0.017364109189745843,
        3: -0.018544456454265796,
        4: 14.811522032867726,
        5: 9.38317630848247,
        6: -5.2284261999445425,
        7: -48.95128052584765,
        8: 38.297096034337926,
        9: -10.58738133697598,
        10: 2.4332304376226275,
        11: -1.0453406042575444,
        12: 0.0717732095086726,
        13: 0.0021622109708082783,
        14: 0.007009595759602514,
    },
)
_V12 = np.array(
    [
        0.012127868517185414,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.09083943422704079,
        0.3156836976483934,
        -0.2632249065769097,
        0.3047803786184589,
        -0.041551616155429835,
        0.2467756096762953,
        0.15226053010586602,
        0.08143848163026961,
        0.08502571193890811,
        -0.009155189630077963,
        0.025,
    ]
)
_E12 = np.array(
    [
        -0.004880833389821577,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.014776975352481408,
        -0.1493490240100479,
        0.2725366201021616,
        -0.19840222383356862,
        0.22106138599523378,
        -0.17944618020981415,
        0.04489732194574983,
        -0.03270117761115586,
        0.015662325288859434,
        -0.029155189630077964,
        0.025,
        0.0,
    ]
)

RKN12 = _nystrom(_A12, _V12, _C12, _E12, 11.0, (7, 5))
