"""Types of hshfit. The docstrings of the module have shapes, units and sources."""
import os
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

import numpy
from numpy.typing import ArrayLike, NDArray

__version__: str

Floats = NDArray[numpy.float64]
Path = Union[str, "os.PathLike[str]"]
Names = Union[str, Sequence[Union[str, int]]]
Numbers = Union[str, float, Sequence[float], None]
Lights = Union[Path, Sequence[Union[Path, Tuple[float, ...]]]]
OutgoingLike = Union[str, int, Tuple[float, float], "Outgoing", None]
Progress = Optional[Callable[[str, int, int], object]]
Row = Dict[str, Any]

class Error(Exception):
    exit_code: int

class UsageError(Error): ...
class InputError(Error): ...
class NumericError(Error): ...
class OutputError(Error): ...

class Brdf:
    @property
    def name(self) -> str: ...
    @property
    def channels(self) -> List[str]: ...
    @property
    def wavelengths(self) -> Floats: ...
    @property
    def laws(self) -> Dict[str, bool]: ...
    @property
    def facts(self) -> Row: ...
    def __call__(self, wi: ArrayLike, wo: ArrayLike, *, cosine: bool = ...) -> Floats: ...
    def albedo(
        self, wo: ArrayLike, *, tolerance: float = ..., progress: Progress = ...
    ) -> Floats: ...
    def reflectance(
        self, wi: ArrayLike, *, tolerance: float = ..., progress: Progress = ...
    ) -> Floats: ...
    def sphere(
        self, size: int = ..., *, samples: int = ..., progress: Progress = ...
    ) -> NDArray[numpy.float32]: ...
    def write(
        self,
        path: Path,
        *,
        format: str = ...,
        measure_loss: bool = ...,
        force: bool = ...,
        progress: Progress = ...,
    ) -> Row: ...
    def _repr_html_(self) -> str: ...

class Outgoing:
    def __init__(self, set: OutgoingLike) -> None: ...
    @property
    def spec(self) -> str: ...
    @property
    def map(self) -> str: ...
    @property
    def directions(self) -> Floats: ...
    @property
    def angles(self) -> Floats: ...
    @property
    def solid_angles(self) -> Floats: ...
    def __len__(self) -> int: ...

class Basis:
    def __init__(self, name: str, order: int, *, condon_shortley: bool = ...) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def order(self) -> int: ...
    @property
    def slots(self) -> int: ...
    @property
    def condon_shortley(self) -> bool: ...
    @property
    def inner(self) -> str: ...
    @property
    def has(self) -> NDArray[numpy.bool_]: ...
    @property
    def indices(self) -> Tuple[NDArray[numpy.int32], NDArray[numpy.int32]]: ...
    def __call__(self, directions: ArrayLike) -> Floats: ...
    def _repr_html_(self) -> str: ...

class Rotation:
    def __init__(
        self,
        *,
        euler: Optional[ArrayLike] = ...,
        axis: Optional[ArrayLike] = ...,
        up: Optional[ArrayLike] = ...,
        matrix: Optional[ArrayLike] = ...,
    ) -> None: ...
    @property
    def matrix(self) -> Floats: ...
    def inverse(self) -> Rotation: ...
    def __call__(self, directions: ArrayLike) -> Floats: ...
    def __matmul__(self, first: Rotation) -> Rotation: ...

class Coefficients:
    @property
    def basis(self) -> str: ...
    @property
    def order(self) -> int: ...
    @property
    def condon_shortley(self) -> bool: ...
    @property
    def quantity(self) -> str: ...
    @property
    def channels(self) -> List[str]: ...
    @property
    def outgoing(self) -> Outgoing: ...
    @property
    def energy(self) -> Row: ...
    @property
    def error(self) -> float: ...
    @property
    def source(self) -> str: ...
    @property
    def values(self) -> Floats: ...
    def with_values(self, values: ArrayLike) -> Coefficients: ...
    def brdf(self) -> Brdf: ...
    def rotate(
        self, rotation: Rotation, *, method: str = ..., tolerance: float = ..., tables: int = ...
    ) -> Tuple[Coefficients, Row]: ...
    def save(self, path: Path) -> None: ...

class Form:
    @property
    def basis(self) -> str: ...
    @property
    def order(self) -> int: ...
    @property
    def condon_shortley(self) -> bool: ...
    @property
    def quantity(self) -> str: ...
    @property
    def channels(self) -> List[str]: ...
    @property
    def outgoing(self) -> Outgoing: ...
    @property
    def energy(self) -> Row: ...
    @property
    def error(self) -> float: ...
    @property
    def source(self) -> str: ...
    @property
    def kind(self) -> str: ...
    @property
    def bytes(self) -> int: ...
    @property
    def entropy_bytes(self) -> int: ...
    @property
    def numbers(self) -> int: ...
    @property
    def added(self) -> str: ...
    @property
    def steps(self) -> List[Tuple[str, float]]: ...
    def brdf(self) -> Brdf: ...
    def decoded(self) -> Coefficients: ...
    def save(self, path: Path) -> None: ...

class Projection:
    @property
    def coefficients(self) -> Optional[Coefficients]: ...
    @property
    def form(self) -> Optional[Form]: ...
    @property
    def captured(self) -> Floats: ...
    @property
    def accuracy(self) -> float: ...
    @property
    def energy(self) -> Row: ...
    @property
    def error(self) -> float: ...
    @property
    def evaluations(self) -> int: ...
    @property
    def errors(self) -> Optional[Row]: ...
    @property
    def poor(self) -> Optional[Row]: ...
    @property
    def picture(self) -> Optional[Row]: ...
    def brdf(self) -> Brdf: ...
    def save(self, path: Path) -> None: ...
    def _repr_html_(self) -> str: ...

class Curve:
    @property
    def basis(self) -> str: ...
    @property
    def best_terms(self) -> bool: ...
    @property
    def orders(self) -> NDArray[numpy.int32]: ...
    @property
    def coefficients(self) -> NDArray[numpy.int32]: ...
    @property
    def accuracy(self) -> Floats: ...
    def reaching(self, accuracy: float) -> Optional[Tuple[int, int]]: ...

class Curves:
    @property
    def brdf(self) -> str: ...
    @property
    def quantity(self) -> str: ...
    @property
    def outgoing(self) -> Outgoing: ...
    @property
    def energy(self) -> Row: ...
    @property
    def error(self) -> float: ...
    @property
    def bases(self) -> List[str]: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Curve]: ...
    def __getitem__(self, basis: str) -> Curve: ...
    def json(self) -> str: ...
    def save(self, folder: Path) -> None: ...
    def _repr_html_(self) -> str: ...

class Comparison:
    @property
    def a(self) -> str: ...
    @property
    def b(self) -> str: ...
    @property
    def outgoing(self) -> Outgoing: ...
    @property
    def metrics(self) -> Dict[str, Row]: ...
    @property
    def pairs(self) -> Optional[Row]: ...
    @property
    def samples(self) -> Optional[Row]: ...
    @property
    def picture(self) -> Optional[Row]: ...
    @property
    def files(self) -> List[str]: ...
    @property
    def figures(self) -> List[str]: ...
    def __getitem__(self, metric: str) -> float: ...
    def _repr_html_(self) -> str: ...

class FittedParameter:
    @property
    def name(self) -> str: ...
    @property
    def channel(self) -> str: ...
    @property
    def value(self) -> float: ...
    @property
    def bound(self) -> str: ...
    @property
    def standard_error(self) -> float: ...
    @property
    def linear(self) -> bool: ...

class Fit:
    @property
    def model(self) -> str: ...
    @property
    def spec(self) -> str: ...
    @property
    def parameters(self) -> List[FittedParameter]: ...
    @property
    def correlations(self) -> Floats: ...
    @property
    def covariance(self) -> Floats: ...
    @property
    def ambiguous(self) -> List[List[str]]: ...
    @property
    def converged(self) -> bool: ...
    @property
    def message(self) -> str: ...
    @property
    def rms(self) -> float: ...
    @property
    def aic(self) -> float: ...
    @property
    def bic(self) -> float: ...
    @property
    def samples(self) -> int: ...
    @property
    def explained(self) -> float: ...
    @property
    def poor(self) -> Optional[Row]: ...
    @property
    def picture(self) -> Optional[Row]: ...
    @property
    def preset(self) -> Row: ...
    @property
    def bands(self) -> List[Row]: ...
    @property
    def figures(self) -> List[str]: ...
    def predict(
        self, wi: ArrayLike, wo: ArrayLike, *, probability: float = ..., seed: int = ...
    ) -> Row: ...
    def brdf(self) -> Brdf: ...
    def save(self, path: Path) -> None: ...
    def _repr_html_(self) -> str: ...

class Library:
    def __init__(self, path: Path) -> None: ...
    @staticmethod
    def learn(
        specs: Union[Path, Sequence[Path]],
        file: Path,
        *,
        components: Union[int, str] = ...,
        bytes: int = ...,
        held_out: float = ...,
        limit: Optional[float] = ...,
        limit_maximum: Optional[float] = ...,
        limit_flip: Optional[float] = ...,
        add_to: Optional[Path] = ...,
        seconds: Optional[float] = ...,
        final: bool = ...,
        progress: Progress = ...,
    ) -> Library: ...
    @property
    def path(self) -> str: ...
    @property
    def names(self) -> List[str]: ...
    @property
    def left_out(self) -> List[str]: ...
    @property
    def mean(self) -> Floats: ...
    @property
    def components(self) -> Floats: ...
    def coefficients(self, name: str) -> Floats: ...
    def encode(
        self,
        spec: str,
        file: Path,
        *,
        components: Union[int, str] = ...,
        limit: Optional[float] = ...,
        limit_maximum: Optional[float] = ...,
        limit_flip: Optional[float] = ...,
        progress: Progress = ...,
    ) -> Row: ...
    def map(self, file: Path, *, near: float = ..., progress: Progress = ...) -> Row: ...
    def reconstruct(
        self,
        samples: Path,
        file: Path,
        *,
        sigma: str = ...,
        bands: Optional[Path] = ...,
        bands_to: Optional[Path] = ...,
        progress: Progress = ...,
    ) -> Row: ...
    def next(
        self,
        count: int = ...,
        *,
        sigma: str = ...,
        instrument: str = ...,
        samples: Optional[Path] = ...,
    ) -> Floats: ...

class Light:
    @property
    def basis(self) -> str: ...
    @property
    def order(self) -> int: ...
    @property
    def condon_shortley(self) -> bool: ...
    @property
    def normal(self) -> Optional[Tuple[float, float]]: ...
    @property
    def channels(self) -> List[str]: ...
    @property
    def values(self) -> Floats: ...
    @property
    def energy(self) -> Row: ...
    @property
    def error(self) -> float: ...
    @property
    def bands(self) -> Floats: ...
    @property
    def curves(self) -> Dict[str, Floats]: ...
    @property
    def enough(self) -> Dict[float, Optional[int]]: ...
    @property
    def split(self) -> Optional[Row]: ...
    @property
    def source(self) -> str: ...
    def rotate(
        self, rotation: Rotation, *, method: str = ..., tolerance: float = ..., tables: int = ...
    ) -> Tuple[Light, Row]: ...
    def save(self, path: Path) -> None: ...
    def _repr_html_(self) -> str: ...

BrdfLike = Union[Brdf, Coefficients, Form, Projection, Fit, Path]
LightLike = Union[Path, Sequence[Path]]

def set_threads(count: int) -> None: ...
def threads() -> int: ...
def catalog(kind: str) -> List[Row]: ...
def open(spec: Path, *, rgb: bool = ...) -> Brdf: ...
def function(
    f: Callable[[Floats, Floats], ArrayLike],
    *,
    name: Optional[str] = ...,
    channels: Union[str, ArrayLike] = ...,
    isotropic: bool = ...,
    reciprocal: bool = ...,
    mirror_symmetric: bool = ...,
    non_negative: bool = ...,
    halfway_width: float = ...,
    tolerance: float = ...,
) -> Brdf: ...
def direction(theta: ArrayLike, phi: ArrayLike = ...) -> Floats: ...
def plot(
    basis: str,
    path: Path,
    *,
    order: int = ...,
    condon_shortley: bool = ...,
    domain: Optional[str] = ...,
) -> Row: ...
def matrix(
    from_basis: str,
    to_basis: str,
    *,
    order: int = ...,
    from_order: int = ...,
    condon_shortley: bool = ...,
    weight: str = ...,
    rotation: Optional[Rotation] = ...,
) -> Floats: ...
def project(
    brdf: BrdfLike,
    *,
    basis: str = ...,
    order: int = ...,
    outgoing: OutgoingLike = ...,
    rgb: bool = ...,
    cosine: bool = ...,
    condon_shortley: bool = ...,
    tolerance: float = ...,
    max_evaluations: float = ...,
    least_squares: bool = ...,
    regularise: float = ...,
    kernel: float = ...,
    form: str = ...,
    halfway: Names = ...,
    reciprocal: bool = ...,
    split: Optional[Path] = ...,
    window: str = ...,
    non_negative: bool = ...,
    energy_preserving: bool = ...,
    rank: int = ...,
    rank_error: float = ...,
    non_negative_factors: bool = ...,
    keep: int = ...,
    precision: str = ...,
    progress: Progress = ...,
) -> Projection: ...
def project_all(
    brdf: BrdfLike,
    *,
    bases: Names = ...,
    order: int = ...,
    outgoing: OutgoingLike = ...,
    cosine: bool = ...,
    condon_shortley: bool = ...,
    rgb: bool = ...,
    tolerance: float = ...,
    progress: Progress = ...,
) -> Dict[str, Projection]: ...
def curves(
    brdf: BrdfLike,
    *,
    bases: Names = ...,
    max_order: int = ...,
    outgoing: OutgoingLike = ...,
    wavelets: bool = ...,
    rgb: bool = ...,
    cosine: bool = ...,
    tolerance: float = ...,
    max_evaluations: float = ...,
    progress: Progress = ...,
) -> Curves: ...
def compare(
    a: BrdfLike,
    b: BrdfLike,
    *,
    metrics: Names = ...,
    outgoing: OutgoingLike = ...,
    sigma: Optional[Path] = ...,
    rgb: bool = ...,
    figures: Optional[Path] = ...,
    figure_width: str = ...,
    font: str = ...,
    font_size: str = ...,
    axis: str = ...,
    panels: str = ...,
    folder: Optional[Path] = ...,
    progress: Progress = ...,
) -> Comparison: ...
def picture_error(
    a: BrdfLike, b: BrdfLike, *, progress: Progress = ...
) -> Optional[Row]: ...
def fit(
    data: BrdfLike,
    model: str,
    *,
    parts: Names = ...,
    loss: str = ...,
    robust: str = ...,
    robust_scale: float = ...,
    per_channel: bool = ...,
    dispersion: str = ...,
    weights: str = ...,
    at: str = ...,
    grazing_cut: float = ...,
    samples: int = ...,
    starts: int = ...,
    iterations: int = ...,
    seconds: Optional[float] = ...,
    seed: int = ...,
    sigma: Optional[Path] = ...,
    calibration: str = ...,
    budget: Optional[Path] = ...,
    scans: str = ...,
    bootstrap: int = ...,
    profile: bool = ...,
    residuals: Optional[Path] = ...,
    bands: Optional[Path] = ...,
    bands_to: Optional[Path] = ...,
    certificate: Optional[Path] = ...,
    certificate_fields: Optional[Path] = ...,
    accept: bool = ...,
    rgb: bool = ...,
    figures: Optional[Path] = ...,
    figure_width: str = ...,
    font: str = ...,
    font_size: str = ...,
    axis: str = ...,
    panels: str = ...,
    instrument: Optional[Mapping[str, Any]] = ...,
    progress: Progress = ...,
) -> Fit: ...
def rank_models(
    data: BrdfLike,
    models: Sequence[str],
    *,
    loss: str = ...,
    samples: int = ...,
    starts: int = ...,
    seed: int = ...,
    rgb: bool = ...,
    progress: Progress = ...,
) -> List[Row]: ...
def light(
    spec: LightLike,
    *,
    basis: str = ...,
    order: int = ...,
    wavelets: bool = ...,
    condon_shortley: bool = ...,
    tolerance: float = ...,
    normal: Optional[ArrayLike] = ...,
    split_sun: Optional[Path] = ...,
    progress: Progress = ...,
) -> Light: ...
def irradiance(
    spec: LightLike,
    *,
    order: int = ...,
    window: str = ...,
    normals: int = ...,
    convention: Optional[str] = ...,
    engine: Optional[str] = ...,
    progress: Progress = ...,
) -> Row: ...
def read(path: Path) -> Union[Coefficients, Form, Light, Brdf]: ...
def convert(
    input: Path,
    output: Path,
    *,
    format: str = ...,
    measure_loss: bool = ...,
    outgoing: OutgoingLike = ...,
    repairs: Names = ...,
    rgb: bool = ...,
    force: bool = ...,
    progress: Progress = ...,
) -> Row: ...
def export(
    coefficients: Path,
    folder: Path,
    *,
    targets: Names = ...,
    outgoing: OutgoingLike = ...,
    basis: str = ...,
    order: int = ...,
    name: str = ...,
    number: str = ...,
    storage: str = ...,
    packing: str = ...,
    chroma: bool = ...,
    chroma_order: int = ...,
    basis_textures: int = ...,
    environment_order: int = ...,
    prefix: str = ...,
    source: Optional[Path] = ...,
    allow_loss: bool = ...,
    measure_error: bool = ...,
    lights: Lights = ...,
    library: Optional[Path] = ...,
    sampling: Optional[bool] = ...,
    zstd: bool = ...,
    force: bool = ...,
    progress: Progress = ...,
) -> Row: ...
def export_material(
    spec: Path,
    folder: Path,
    *,
    targets: Names = ...,
    name: str = ...,
    source: Optional[Path] = ...,
    force: bool = ...,
    mesh: Optional[Path] = ...,
    extensions: str = ...,
    progress: Progress = ...,
) -> Row: ...
def export_lighting(
    spec: Path,
    folder: Path,
    *,
    targets: Names = ...,
    name: str = ...,
    number: str = ...,
    environment_order: int = ...,
    prefix: str = ...,
    source: Optional[Path] = ...,
    measure_error: bool = ...,
    lights: Lights = ...,
    force: bool = ...,
    lighting: Names = ...,
    engine: str = ...,
    lobes: int = ...,
    seconds: Optional[float] = ...,
    progress: Progress = ...,
) -> Row: ...
def import_coefficients(
    input: Path,
    output: Path,
    *,
    force: bool = ...,
) -> None: ...
def describe(
    spec: Path,
    *,
    rgb: bool = ...,
    progress: Progress = ...,
) -> Row: ...
def sample(
    spec: Path,
    wo: ArrayLike,
    *,
    count: int = ...,
    method: str = ...,
    seed: int = ...,
    progress: Progress = ...,
) -> Row: ...
def render(
    specs: Union[Path, Sequence[Path]],
    path: Path,
    *,
    size: int = ...,
    samples: Optional[int] = ...,
    light: Lights = ...,
    dome: Optional[float] = ...,
    exposure: Numbers = ...,
    mesh: Optional[Path] = ...,
    up: str = ...,
    view: Numbers = ...,
    field_of_view: float = ...,
    by: str = ...,
    bases: Names = ...,
    orders: Union[int, Sequence[int]] = ...,
    cosine: bool = ...,
    outgoing: OutgoingLike = ...,
    exposures: Union[float, Sequence[float]] = ...,
    tolerance: Optional[float] = ...,
    seconds: Optional[float] = ...,
    progress: Progress = ...,
) -> Row: ...
def illuminate(
    scene: Path,
    folder: Path,
    *,
    method: str = ...,
    camera: str = ...,
    samples: Optional[int] = ...,
    bounces: int = ...,
    from_bounce: int = ...,
    seed: int = ...,
    reference: Optional[Path] = ...,
    exposure: Optional[float] = ...,
    resume: bool = ...,
    seconds: Optional[float] = ...,
    force: bool = ...,
    records: Optional[Path] = ...,
    basis: str = ...,
    order: int = ...,
    loss: float = ...,
    choose_by: str = ...,
    rays: int = ...,
    accuracy: float = ...,
    least_reach: float = ...,
    direct: str = ...,
    gradient: str = ...,
    without: Names = ...,
    published: bool = ...,
    surface_points: int = ...,
    surface_rays: int = ...,
    memory: float = ...,
    progress: Progress = ...,
) -> Row: ...
def transfer(
    scene: Path,
    folder: Path,
    *,
    kind: str = ...,
    passes: int = ...,
    rays: int = ...,
    order: int = ...,
    local_order: int = ...,
    clusters: Union[int, Sequence[int]] = ...,
    components: int = ...,
    error: float = ...,
    bytes: Optional[int] = ...,
    edge: Optional[float] = ...,
    sides: str = ...,
    seed: int = ...,
    memory: float = ...,
    lights: Lights = ...,
    reference_samples: int = ...,
    materials: Names = ...,
    camera: str = ...,
    resume: bool = ...,
    seconds: Optional[float] = ...,
    force: bool = ...,
    progress: Progress = ...,
) -> Row: ...
def svbrdf(
    description: Path,
    folder: Path,
    *,
    form: str = ...,
    basis: str = ...,
    order: int = ...,
    outgoing: OutgoingLike = ...,
    cosine: bool = ...,
    precision: str = ...,
    tolerance: float = ...,
    rank: int = ...,
    error: Optional[float] = ...,
    harmonics: int = ...,
    halfway: Names = ...,
    clusters: int = ...,
    library: Optional[Path] = ...,
    components: int = ...,
    mips: bool = ...,
    checks: int = ...,
    seconds: Optional[float] = ...,
    memory: int = ...,
    direct: bool = ...,
    force: bool = ...,
    progress: Progress = ...,
) -> Row: ...
def plan(
    scene: Path,
    folder: Path,
    *,
    bases: Names = ...,
    max_order: int = ...,
    costs: bool = ...,
    formulas: Names = ...,
    by_time: bool = ...,
    seconds: Optional[float] = ...,
    cache: Optional[Path] = ...,
    progress: Progress = ...,
) -> Row: ...
def choose(
    spec: str,
    folder: Optional[Path] = ...,
    *,
    renderer: str = ...,
    kinds: Names = ...,
    bytes: Optional[int] = ...,
    cost: Optional[int] = ...,
    error: Optional[float] = ...,
    seconds: float = ...,
    cache: Optional[Path] = ...,
    progress: Progress = ...,
) -> Row: ...
def ltc(
    model: str,
    files: Union[Path, Sequence[Path]],
    *,
    size: int = ...,
    parameter: str = ...,
    mapping: str = ...,
    progress: Progress = ...,
) -> Row: ...
def gaussians(
    spec: str,
    file: Path,
    *,
    lobes: int = ...,
    kind: str = ...,
    outgoing: OutgoingLike = ...,
    loss: str = ...,
    keep_energy: bool = ...,
    metrics: Names = ...,
    rgb: bool = ...,
    progress: Progress = ...,
) -> Row: ...
def stress(
    specs: Sequence[str] = ...,
    folder: Optional[Path] = ...,
    *,
    bases: Names = ...,
    max_order: int = ...,
    trials: Optional[int] = ...,
    seed: int = ...,
    tolerance: float = ...,
    of: Names = ...,
    progress: Progress = ...,
) -> Row: ...
def tradeoff(
    specs: Union[Path, Sequence[Path]],
    folder: Optional[Path] = ...,
    *,
    forms: Names = ...,
    bases: Names = ...,
    orders: Union[int, Sequence[int]] = ...,
    ranks: Union[int, Sequence[int]] = ...,
    precisions: Names = ...,
    keep: Union[int, Sequence[int]] = ...,
    windows: Names = ...,
    constraints: Names = ...,
    outgoing: Names = ...,
    halfway: Names = ...,
    splits: Names = ...,
    cosine: bool = ...,
    metric: str = ...,
    max_bytes: Optional[float] = ...,
    max_ns: Optional[float] = ...,
    timing: bool = ...,
    gpu: bool = ...,
    device: str = ...,
    costs: bool = ...,
    formulas: Names = ...,
    by_time: bool = ...,
    pair_count: int = ...,
    pairs: Optional[Path] = ...,
    write_pairs: Optional[Path] = ...,
    seconds: Optional[float] = ...,
    cache: Optional[Path] = ...,
    wavelets: bool = ...,
    rgb: bool = ...,
    tolerance: float = ...,
    max_evaluations: float = ...,
    progress: Progress = ...,
) -> Row: ...
