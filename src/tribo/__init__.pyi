"""The public names and the modules that they are from; `__init__.py` reads them here."""

from tribo import (
    paper as paper,
    plotting as plotting,
    potentials as potentials,
    units as units,
)
from tribo.derivatives import sensitivity as sensitivity
from tribo.ensembles import ensemble as ensemble, ensemble_member as ensemble_member
from tribo.ensembles.swing_states import (
    Canonical as Canonical,
    EnergyBall as EnergyBall,
    Microcanonical as Microcanonical,
)
from tribo.explanation import Explanation as Explanation, explain as explain
from tribo.integrators.own_method import add_method as add_method
from tribo.ledger.own_quantity import Quantity as Quantity
from tribo.live_pages.page import live as live, to_live_html as to_live_html
from tribo.model.asperite import Asperite as Asperite
from tribo.model.bars import Ends as Ends
from tribo.model.bath import Bath as Bath
from tribo.model.drives import (
    DrivenBars as DrivenBars,
    Forced as Forced,
    Free as Free,
    Moved as Moved,
    Pulled as Pulled,
    Pushed as Pushed,
)
from tribo.model.own_drive import Custom as Custom
from tribo.model.fields import Corrugation as Corrugation, Field as Field
from tribo.model.initial import Initial as Initial
from tribo.model.interaction import Interaction as Interaction, Periodic as Periodic
from tribo.model.langevin import Langevin as Langevin
from tribo.model.roughness import Roughness as Roughness
from tribo.model.rows import (
    commensurate_rows as commensurate_rows,
    incommensurate_rows as incommensurate_rows,
    periodic_rows as periodic_rows,
)
from tribo.model.scene import Scene as Scene
from tribo.model.schedule import Schedule as Schedule
from tribo.model.scene_file import load_scene as load_scene
from tribo.model.settings import Numerics as Numerics, Output as Output
from tribo.model.spectrum import Spectrum as Spectrum
from tribo.model.elastic import Elastic as Elastic
from tribo.model.springs import Springs as Springs
from tribo.model.surface import Surface as Surface
from tribo.model.topography import Topography as Topography
from tribo.potentials import (
    BornMayer as BornMayer,
    Buckingham as Buckingham,
    Coulomb as Coulomb,
    Gaussian as Gaussian,
    Hertz as Hertz,
    LennardJones as LennardJones,
    Mie as Mie,
    Morse as Morse,
    Plummer as Plummer,
    Potential as Potential,
    SoftSphere as SoftSphere,
    WeeksChandlerAndersen as WeeksChandlerAndersen,
    Yukawa as Yukawa,
)
from tribo.prepared import Simulation as Simulation
from tribo.report_card import check as check
from tribo.results.averages import Average as Average, time_average as time_average
from tribo.results.exponential_average import (
    ExponentialAverage as ExponentialAverage,
    exponential_average as exponential_average,
)
from tribo.analysis.relax import NoEquilibriumError as NoEquilibriumError, relax as relax
from tribo.result import Result as Result
from tribo.result import load_result as load_result
from tribo.loops.saved_state import State as State
from tribo.simulation import prepare as prepare, simulate as simulate
from tribo.fitting import fit as fit
from tribo.fitting.found import Fit as Fit
from tribo.sliders import play as play
from tribo.sweeps import sweep as sweep
from tribo.sweeps.friction_law import friction_law as friction_law
from tribo.validation import InputError as InputError, TriboWarning as TriboWarning

__version__: str
