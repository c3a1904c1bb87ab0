# SPDX-License-Identifier: Apache-2.0
import gc
import re
import signal
import threading
import time

import numpy as np
import pytest
from scene import HEIGHT, SAMPLES, WIDTH, Scene

import stein


def mse(a, b):
    return float(np.mean((a - b) ** 2))


def test_less_error_than_the_input_and_the_estimate_is_near_it():
    noise, true_error, estimate = [], [], []
    for seed in range(1, 9):  # of one image the mean risk has a standard error of sqrt(2 / 2880) of the noise
        scene = Scene(seed)
        result = stein.denoise(**scene.arguments())
        noise.append(mse(scene.colour, scene.truth))
        true_error.append(mse(result.colour, scene.truth))
        estimate.append(float(result.error.mean()))
        assert true_error[-1] < 0.2 * noise[-1]
        assert result.density.mean() == pytest.approx(1, rel=1e-4)
    assert abs(np.mean(estimate) - np.mean(true_error)) < 0.05 * np.mean(noise)


def test_results_are_arrays_of_stein_s_memory():
    result = stein.denoise(**Scene().arguments())
    for array in (result.colour, result.error):
        assert array.shape == (HEIGHT, WIDTH, 3) and array.dtype == np.float32
    for array in (result.choice, result.density):
        assert array.shape == (HEIGHT, WIDTH) and array.dtype == np.float32
    first, again = result.colour, result.colour
    assert np.shares_memory(first, again) and not first.flags.owndata
    first[3, 4, 1] = 42
    assert again[3, 4, 1] == 42


def test_arrays_outlive_the_result():
    result = stein.denoise(**Scene().arguments())
    expected = result.colour.copy()
    colour = result.colour
    del result
    gc.collect()
    assert np.array_equal(colour, expected)


def layouts(array):
    """The same pixels in other memory layouts."""
    wide = np.zeros((2 * HEIGHT, 3 * WIDTH, 5), np.float32)
    spread = wide[::2, ::3, 1:4]
    spread[...] = array
    yield "interleaved", np.ascontiguousarray(array)
    yield "planar", np.moveaxis(np.ascontiguousarray(np.moveaxis(array, 2, 0)), 0, 2)
    yield "columns", np.asfortranarray(array)
    yield "list", [np.ascontiguousarray(array[..., c]) for c in range(3)]
    yield "strided", spread
    yield "upside down", np.ascontiguousarray(array[::-1, ::-1])[::-1, ::-1]
    read_only = array.copy()
    read_only.flags.writeable = False
    yield "read-only", read_only
    yield "buffer", memoryview(np.ascontiguousarray(array))


def test_any_memory_layout_gives_the_same_result():
    scene = Scene()
    expected = stein.denoise(**scene.arguments()).colour
    variances = dict(layouts(scene.variance))
    for name, colour in layouts(scene.colour):
        arguments = scene.arguments() | {"colour": colour, "variance": variances[name]}
        assert np.array_equal(stein.denoise(**arguments).colour, expected), name


def test_nothing_is_copied_on_the_way_in():
    scene = Scene()
    frame = stein.Frame(**scene.arguments())
    assert frame.features == ["albedo"]
    assert (frame.width, frame.height) == (WIDTH, HEIGHT)
    assert np.shares_memory(frame.planes["G"], scene.colour)
    assert np.shares_memory(frame.planes["albedo.variance.B"], scene.albedo_variance)
    before = stein.denoise(frame).colour.copy()
    scene.colour += 1
    assert np.allclose(stein.denoise(frame).colour, before + 1, atol=0.05)


def test_frames_keep_their_arrays():
    planes = stein.Frame(**Scene().arguments()).planes
    gc.collect()
    assert np.array_equal(planes["R"], Scene().colour[..., 0])
    with pytest.raises(ValueError):
        planes["R"][0, 0] = 1


def test_half_and_counts():
    scene = Scene()
    arguments = scene.arguments()
    arguments["features"] = {"albedo": (scene.albedo.astype(np.float16), scene.albedo_variance)}
    arguments["samples"] = np.full((HEIGHT, WIDTH), SAMPLES, np.uint32)
    expected = stein.denoise(**scene.arguments()).colour
    assert np.allclose(stein.denoise(**arguments).colour, expected, atol=2e-3)


def test_one_channel_stands_for_all():
    scene = Scene()
    arguments = scene.arguments() | {"variance": scene.variance[..., 0]}
    assert np.array_equal(stein.denoise(**arguments).colour, stein.denoise(**scene.arguments()).colour)


def test_covariances_lead_to_joint_sure():
    scene = Scene()
    arguments = scene.arguments()
    arguments["covariance"] = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    arguments["features"] = {
        "albedo": (scene.albedo, scene.albedo_variance, np.zeros((HEIGHT, WIDTH, 3, 3), np.float32)),
        "depth": scene.albedo[..., 0],
    }
    result = stein.denoise(**arguments)
    assert "joint" in result.report["filters"][0]["risk"]
    planes = stein.Frame(**arguments).planes
    assert {"covariance.G.B", "covariance.B.albedo.R", "depth.Z"} <= planes.keys()


def test_every_filter_runs():
    results = [stein.denoise(**Scene().arguments(), filter=name) for name in stein.filter_names()]
    assert len(results) >= 6
    assert len({result.colour.tobytes() for result in results}) == len(results)
    assert [result.report["filter"] for result in results] == stein.filter_names()


def test_options_change_what_they_say():
    scene = Scene()
    plain = stein.denoise(**scene.arguments())

    def run(**options):
        return stein.denoise(**scene.arguments(), **options)

    assert np.array_equal(run(strength=0).colour, scene.colour)
    assert len(run(filter="cross-bilateral", bank="intermediate").report["candidates"]) == 4
    scales = run(filter="cross-bilateral", spatial_sigmas=[1, 2.5]).report["candidates"]
    assert scales == ["input", "sigma_s=1", "sigma_s=2.5"]
    assert [share["name"] for share in run(filter="gaussian,atrous").report["filters"]] == ["gaussian", "atrous"]
    assert [share["name"] for share in run(threads=1, quality="fast").report["filters"]] == ["atrous-sure"]
    assert "Monte Carlo" in run(risk="monte-carlo").report["filters"][0]["risk"]
    assert not np.array_equal(run(feature_sigmas={"albedo": 0}).colour, plain.colour)
    assert not np.array_equal(run(filter="cross-nlm", window_radius=3).colour, run(filter="cross-nlm").colour)
    assert np.array_equal(run(threads=1, tile_width=16, tile_height=4).colour, plain.colour)


def test_options_are_those_of_the_library():
    with pytest.raises(stein.InvalidArgument) as refused:
        stein.denoise(**Scene().arguments(), tempo=1)
    listed = str(refused.value).split("there are: ")[1].split(", ")
    names = {name.replace("-", "_") for name in listed if "<" not in name}
    assert names == stein.Options.__annotations__.keys()


def test_reports():
    scene = Scene()
    scene.colour[2, 3] = np.nan
    report = stein.denoise(**scene.arguments()).report
    assert report.keys() == stein.Report.__annotations__.keys()
    assert report["invalid_pixels"] == 1
    assert report["bad_feature_pixels"] == {"albedo": 0}
    assert sum(report["choice_share"].values()) == pytest.approx(1)
    assert len(report["mean_error"]) == 3 and report["candidates"][0] == "input"


@pytest.mark.parametrize(
    "change, message",
    [
        ({"colour": [[1.0]]}, "colour is of type list"),
        ({"colour": Scene().colour.astype(np.float64)}, "colour is of type float64"),
        ({"colour": Scene().colour.astype(">f4")}, "colour is of type"),
        ({"colour": Scene().colour[0, 0]}, "colour has 1 axes"),
        ({"colour": Scene().colour[..., :2]}, "colour has 2 channels"),
        ({"colour": np.zeros((0, 4, 3), np.float32)}, "0 x 4 pixels"),
        ({"variance": np.broadcast_to(np.float32(1), (HEIGHT, WIDTH, 3))}, "variance repeats its elements"),
        ({"variance": Scene().variance[1:]}, "variance.R"),
        ({"variance": None}, "variance.R"),
        ({"samples": None}, "samples is missing"),
        ({"samples": "many"}, "samples"),
        ({"features": {"albedo": ()}}, "'albedo' has 0 parts"),
        ({"features": {"albedo": (None,)}}, "albedo"),
        ({"filter": "median"}, "'median'"),
        ({"risk": "none"}, "monte-carlo"),
        ({"strength": 2}, "strength is 2"),
        ({"strength": None}, "strength is neither"),
        ({"filter": "gaussian", "order": "1"}, "'gaussian' has no option order"),
        ({"filter": "gaussian", "quality": "fast"}, "leave out filter, or quality"),
        ({"feature_sigmas": {"depth": 1}}, "no feature 'depth'"),
    ],
)
def test_bad_arguments_are_refused_by_name(change, message):
    with pytest.raises(stein.Error, match=re.escape(message)) as refused:
        stein.denoise(**Scene().arguments() | change)
    assert isinstance(refused.value, ValueError)
    assert refused.value.code in (stein.ErrorCode.INVALID_ARGUMENT, stein.ErrorCode.INVALID_FRAME)


def test_a_frame_has_its_arguments_already():
    frame = stein.Frame(**Scene().arguments())
    with pytest.raises(stein.InvalidArgument, match="already"):
        stein.denoise(frame, samples=4)


def test_strict_names_the_value():
    scene = Scene()
    scene.colour[7, 5, 1] = np.inf
    with pytest.raises(stein.InvalidFrame, match="'?G'?.*5.*7"):
        stein.denoise(**scene.arguments(), strict=True)


def test_progress_rises_to_one():
    done = []
    stein.denoise(**Scene().arguments(), progress=done.append)
    assert len(done) > 3 and done == sorted(done) and done[-1] == pytest.approx(1)


def test_progress_cancels():
    calls = []
    with pytest.raises(stein.Cancelled) as cancelled:
        stein.denoise(**Scene().arguments(), progress=lambda done: calls.append(done) or len(calls) < 2)
    assert len(calls) == 2
    assert cancelled.value.code == stein.ErrorCode.CANCELLED


def test_exceptions_of_the_callback_come_out():
    def fail(done):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        stein.denoise(**Scene().arguments(), progress=fail)


def denoise_for_a_while():
    colour = np.random.default_rng(1).random((256, 256, 3), np.float32)
    return stein.denoise(colour, np.full_like(colour, 0.08), samples=4, filter="cross-nlm")


def test_signals_interrupt():
    class Alarm(Exception):
        pass

    def ring(number, frame):
        raise Alarm

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, 0.01)
    try:
        with pytest.raises(Alarm):
            denoise_for_a_while()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_other_threads_run_meanwhile():
    beats = []
    done = threading.Event()

    def beat():
        while not done.is_set():
            beats.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=beat)
    thread.start()
    begin = time.perf_counter()
    denoise_for_a_while()
    end = time.perf_counter()
    done.set()
    thread.join()
    # Held all the time, the interpreter would give it no beat between the first and the last moments.
    assert sum(begin + 0.25 * (end - begin) < b < begin + 0.75 * (end - begin) for b in beats) >= 3


def test_threads_of_python_may_call_at_the_same_time():
    expected = stein.denoise(**Scene().arguments()).colour
    results = []

    def run():
        results.append(stein.denoise(**Scene().arguments(), progress=lambda done: True).colour)

    threads = [threading.Thread(target=run) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 4 and all(np.array_equal(result, expected) for result in results)


def test_another_denoiser_joins_as_a_function():
    scene = Scene()
    seen = []

    def truth(frame):
        seen.append(frame)
        return scene.truth

    result = stein.denoise(**scene.arguments(), candidates={"truth": (truth, 2)})
    assert len(seen) == 3
    gc.collect()
    colours = [np.stack([frame.planes[c] for c in "RGB"], -1) for frame in seen]  # they outlive the call
    assert np.array_equal(colours[0], scene.colour)
    step = (colours[1] - colours[0]) / np.sqrt(scene.variance)
    assert 0.05 < np.abs(step).mean() < 0.2 and not np.array_equal(colours[1], colours[2])
    assert result.report["candidates"][-1] == "truth"
    assert result.report["filters"][-1]["name"] == "truth"
    own, other = (result.report["filters"][i]["mean_relative_error"] for i in (0, -1))
    assert own > other >= result.report["mean_relative_error"]
    halved = stein.denoise(**scene.arguments(), candidates={"truth": truth}, strength=0.5)
    assert halved.report["filters"][0]["mean_relative_error"] is None
    assert mse(result.colour, scene.truth) < 0.5 * mse(stein.denoise(**scene.arguments()).colour, scene.truth)


def test_denoisers_that_fail():
    arguments = Scene().arguments()

    def raises(frame):
        raise KeyError("cheese")

    with pytest.raises(KeyError, match="cheese"):
        stein.denoise(**arguments, candidates={"a": raises})
    with pytest.raises(stein.InvalidArgument, match="'a'.*2x3"):
        stein.denoise(**arguments, candidates={"a": lambda frame: np.zeros((3, 2, 3), np.float32)})
    with pytest.raises(stein.InvalidArgument, match="'a' returned no image"):
        stein.denoise(**arguments, candidates={"a": lambda frame: None})
    for wrong in (3, (), (raises, 1, 2), (raises, "x")):
        with pytest.raises(stein.InvalidArgument, match="'a' is neither a function"):
            stein.denoise(**arguments, candidates={"a": wrong})
    with pytest.raises(stein.InvalidArgument, match="17"):
        stein.denoise(**arguments, candidates={"a": (raises, 17)})
