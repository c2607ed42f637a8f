"""The commands of many missions: ``bench``, ``compare``, ``report``, ``ablate``."""

from pathlib import Path
from typing import Annotated

import typer

from reasoned_explorer.cli.answers import answering
from reasoned_explorer.cli.model_arguments import BaseUrl, KeyVariable, Prices, SampleAnew, Yes
from reasoned_explorer.model import Fault, SettingsError

ablate_app = typer.Typer(
    help="The paper's ablations: level 1, T_max 15 minutes, captions without error.", no_args_is_help=True
)
_SplitSeed = Annotated[
    int | None,
    typer.Option(help="Deal other episodes.", show_default="the split's own; 1 for --world"),
]
_Cache = Annotated[Path | None, typer.Option(help="File of answers that may be used again; made if need be.")]
_BudgetUsd = Annotated[
    float | None, typer.Option(help="Stop before calls cost more in this sitting, US dollars; --resume goes on.")
]
_BudgetMinutes = Annotated[
    float | None, typer.Option(help="Stop after so many real minutes of this sitting; --resume goes on.")
]
Run = Annotated[Path, typer.Argument(metavar="RUN", help="The folder of a run of rex bench.")]


_BESIDE_RESUME = (
    *(
        "add",
        "workers",
        "ray",
        "base_url",
        "key_variable",
        "prices",
        "cache",
        "sample_anew",
        "budget_usd",
        "budget_minutes",
    ),
    *("yes", "quiet", "resume"),
)
_BESIDE_RESUME_SAID = ", ".join(f"--{name.replace('_', '-')}" for name in _BESIDE_RESUME[:-1]) + " only"


def add_commands(app: typer.Typer) -> None:
    """Add the commands to ``rex``."""
    app.command()(bench)
    app.command()(compare)
    app.command()(report)
    app.add_typer(ablate_app, name="ablate")


def _refuse_beside_resume(context: typer.Context) -> None:
    """Refuse options that a run which is gone on with would not heed.

    Raises:
        SettingsError: With all of them.
    """
    if context.params["resume"] is None:
        return
    given = [
        Fault(
            f"{param.opts[0]} beside --resume",
            _BESIDE_RESUME_SAID,
            "a run knows its own settings",
        )
        for param in context.command.params
        if param.name is not None
        and param.name not in _BESIDE_RESUME
        and getattr(context.get_parameter_source(param.name), "name", "") == "COMMANDLINE"
    ]
    if given:
        raise SettingsError("--resume", given)


@answering
def bench(
    context: typer.Context,
    *,
    split: Annotated[
        str | None,
        typer.Option(help="mini (about a minute) or full (at least 400 missions).", show_default="mini"),
    ] = None,
    planners: Annotated[
        str,
        typer.Option(
            help="Names with commas, e.g. llm-rrt:depth=1,follow-paths+perfect-halt; with minds of their own: "
            "llm-rrt@openai:a/openai:b (visionary/evaluator), llm-as-eval@openai:a (one for both); or a group: "
            "default, planners, bounds, controls, halts, all."
        ),
    ] = "default",
    worlds: Annotated[
        list[str] | None,
        typer.Option(
            "--world",
            "--worlds",
            help="Make a split of these worlds instead, with commas or repeated. Real places "
            "are cut into neighbourhoods of about 1 km². NAME~permuted:SEED deals its labels anew.",
        ),
    ] = None,
    bbox: Annotated[str | None, typer.Option(help="Crop OpenStreetMap files: lon0,lat0,lon1,lat1 (degrees).")] = None,
    per_cell: Annotated[
        int | None, typer.Option(help="Episodes of each level and distance in each place (there are 12 such cells).")
    ] = None,
    split_seed: _SplitSeed = None,
    levels: Annotated[str, typer.Option(help="Only these levels, with commas.")] = "",
    seeds: Annotated[
        str, typer.Option(help="Run each episode with each of these; other seeds make other captions and draws.")
    ] = "0",
    minds: Annotated[str, typer.Option(help="Who imagines, scores and checks; see rex names.")] = "embedded",
    visionary: Annotated[str | None, typer.Option(help="Who imagines, if not --minds.")] = None,
    evaluator: Annotated[str | None, typer.Option(help="Who scores, if not --minds.")] = None,
    checker: Annotated[str | None, typer.Option(help="Who notices the goal, if not --minds.")] = None,
    captioner: Annotated[str, typer.Option(help="Who says what is seen; see rex names.")] = "noisy",
    picture_px: Annotated[int, typer.Option(help="Side of the pictures that a model is shown, pixels.")] = 448,
    conditions: Annotated[str, typer.Option(help="In pictures: clear, overcast, dusk, fog or rain.")] = "clear",
    eyes: Annotated[
        str, typer.Option(help="What simulated captioners go by: lines or pixels; see rex names.")
    ] = "pixels",
    yes: Yes = False,
    vehicle: Annotated[str, typer.Option(help="Vehicle profiles with commas; each has a table of its own.")] = "drone",
    latency: Annotated[str, typer.Option(help="How long modelled calls take; see rex names.")] = "gpt-2023",
    clock: Annotated[
        str | None,
        typer.Option(help="virtual, mixed or real time.", show_default="virtual; mixed where a model is called"),
    ] = None,
    base_url: BaseUrl = None,
    key_variable: KeyVariable = None,
    prices: Prices = None,
    cache: _Cache = None,
    sample_anew: SampleAnew = False,
    budget_usd: _BudgetUsd = None,
    budget_minutes: _BudgetMinutes = None,
    t_max: Annotated[float, typer.Option(help="Mission time above which it is failed, minutes.")] = 30.0,
    radius: Annotated[float, typer.Option(help="Success radius R of the judge, metres.")] = 15.0,
    workers: Annotated[
        int | None, typer.Option(help="Processes on this machine; as many as processors by default.")
    ] = None,
    ray: Annotated[
        str | None, typer.Option(help=r"Run on a Ray cluster: auto, or its address. Needs reasoned-explorer\[ray].")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder of the run; runs/bench-… by default.")] = None,
    resume: Annotated[
        Path | None, typer.Option(metavar="RUN", help="Go on with a run that was stopped; it knows its own settings.")
    ] = None,
    add: Annotated[
        str, typer.Option(help="With --resume: run these planners on its missions, too, e.g. llm-as-eval@openai:a.")
    ] = "",
    traces: Annotated[bool, typer.Option("--traces/--no-traces", help="Keep the record of each mission.")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Only the tables.")] = False,
) -> None:
    """Run planners over the missions of a split, and print one table.

    Exit code 0: all missions ran. 2: bad input. 3: a part failed in a mission, or the disk is full. 4: the budget is
    spent, or a model is gone. 130: stopped with Ctrl-C. What is finished is kept: go on with --resume.
    """
    from reasoned_explorer.cli.bench import BenchOptions, run_bench_from_options
    from reasoned_explorer.cli.models import ModelOptions
    from reasoned_explorer.cli.parsing import parse_worlds

    _refuse_beside_resume(context)
    run_bench_from_options(
        BenchOptions(
            split=split,
            planners=planners,
            worlds=parse_worlds(worlds or ()),
            bbox=bbox,
            per_cell=per_cell,
            split_seed=split_seed,
            levels=levels,
            seeds=seeds,
            minds=minds,
            visionary=visionary,
            evaluator=evaluator,
            checker=checker,
            captioner=captioner,
            picture_px=picture_px,
            conditions=conditions,
            eyes=eyes,
            vehicle=vehicle,
            latency=latency,
            clock=clock,
            t_max_min=t_max,
            radius_m=radius,
            workers=workers,
            ray=ray,
            out=out,
            resume=resume,
            add=add,
            traces=traces,
            quiet=quiet,
            models=ModelOptions(
                base_url=base_url,
                key_variable=key_variable,
                prices=prices,
                cache=cache,
                sample_anew=sample_anew,
                budget_usd=budget_usd,
                budget_minutes=budget_minutes,
                yes=yes,
            ),
        )
    )


@answering
def compare(
    first: Annotated[str, typer.Argument(metavar="A", help="A run, or RUN::PLANNER.")],
    second: Annotated[str, typer.Argument(metavar="B", help="Another run, or RUN::PLANNER (the run may be the same).")],
) -> None:
    """Compare two runs: paired differences with intervals on the missions that both have."""
    from reasoned_explorer.cli.compare import compare_runs

    compare_runs(first, second)


@answering
def report(
    run: Run,
    *,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the report; RUN/report by default. An old report is replaced.")
    ] = None,
) -> None:
    """Make one page of a run, finished or not: tables, figures, trajectories; PNG and CSV beside it.

    Exit code 0: it is written. 2: bad input. 3: the disk is full.
    """
    from reasoned_explorer.cli.report import write_run_report

    write_run_report(run, out)


_Split = Annotated[str | None, typer.Option(help="mini or full; only its level 1 is run.", show_default="full")]
_Worlds = Annotated[
    list[str] | None,
    typer.Option("--world", "--worlds", help="A split of these worlds instead, with commas or repeated."),
]
_Bbox = Annotated[str | None, typer.Option(help="Crop OpenStreetMap files: lon0,lat0,lon1,lat1 (degrees).")]
_PerCell = Annotated[int | None, typer.Option(help="Episodes of each distance in each place.")]
_Seeds = Annotated[str, typer.Option(help="Run each episode with each of these.")]
_Vehicle = Annotated[str, typer.Option(help="Vehicle profiles with commas.")]
_Latency = Annotated[str, typer.Option(help="How long modelled calls take.")]
_Workers = Annotated[int | None, typer.Option(help="Processes on this machine.")]
_Ray = Annotated[str | None, typer.Option(help="Run on a Ray cluster: auto, or its address.")]
_Out = Annotated[Path | None, typer.Option(help="Folder of the run.")]
_Resume = Annotated[Path | None, typer.Option(metavar="RUN", help="Go on with an ablation that was stopped.")]
_Traces = Annotated[bool, typer.Option("--traces/--no-traces", help="Keep the record of each mission.")]
_Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Only the table.")]


@ablate_app.command("depth")
@answering
def ablate_depth_(
    context: typer.Context,
    *,
    depths: Annotated[str, typer.Option(help="L, with commas.")] = "0,1,2,3,4",
    split: _Split = None,
    worlds: _Worlds = None,
    bbox: _Bbox = None,
    per_cell: _PerCell = None,
    split_seed: _SplitSeed = None,
    seeds: _Seeds = "0",
    minds: Annotated[str, typer.Option(help="Who imagines, scores and checks.")] = "embedded",
    vehicle: _Vehicle = "drone",
    latency: _Latency = "gpt-2023",
    base_url: BaseUrl = None,
    key_variable: KeyVariable = None,
    prices: Prices = None,
    cache: _Cache = None,
    sample_anew: SampleAnew = False,
    budget_usd: _BudgetUsd = None,
    budget_minutes: _BudgetMinutes = None,
    workers: _Workers = None,
    ray: _Ray = None,
    out: _Out = None,
    resume: _Resume = None,
    traces: _Traces = True,
    quiet: _Quiet = False,
) -> None:
    """How many steps to think into the future (the paper's Table III).

    Exit codes as of rex bench.
    """
    from reasoned_explorer.cli.ablate import ablate_depth
    from reasoned_explorer.cli.bench import BenchOptions
    from reasoned_explorer.cli.models import ModelOptions
    from reasoned_explorer.cli.parsing import parse_worlds

    _refuse_beside_resume(context)
    options = BenchOptions(
        split=split,
        worlds=parse_worlds(worlds or ()),
        bbox=bbox,
        per_cell=per_cell,
        split_seed=split_seed,
        seeds=seeds,
        minds=minds,
        vehicle=vehicle,
        latency=latency,
        workers=workers,
        ray=ray,
        out=out,
        resume=resume,
        traces=traces,
        quiet=quiet,
        models=ModelOptions(
            base_url=base_url,
            key_variable=key_variable,
            prices=prices,
            cache=cache,
            sample_anew=sample_anew,
            budget_usd=budget_usd,
            budget_minutes=budget_minutes,
        ),
    )
    ablate_depth(options, depths)


@ablate_app.command("minds")
@answering
def ablate_minds_(
    context: typer.Context,
    *,
    visionaries: Annotated[str, typer.Option(help="Minds that imagine, with commas.")] = "embedded,embedded-unknowing",
    evaluators: Annotated[str, typer.Option(help="Minds that score, with commas.")] = "embedded,embedded-unknowing",
    checker: Annotated[str, typer.Option(help="Who notices the goal.")] = "embedded",
    split: _Split = None,
    worlds: _Worlds = None,
    bbox: _Bbox = None,
    per_cell: _PerCell = None,
    split_seed: _SplitSeed = None,
    seeds: _Seeds = "0",
    vehicle: _Vehicle = "drone",
    latency: _Latency = "gpt-2023",
    base_url: BaseUrl = None,
    key_variable: KeyVariable = None,
    prices: Prices = None,
    cache: _Cache = None,
    sample_anew: SampleAnew = False,
    budget_usd: _BudgetUsd = None,
    budget_minutes: _BudgetMinutes = None,
    workers: _Workers = None,
    ray: _Ray = None,
    out: _Out = None,
    resume: _Resume = None,
    traces: _Traces = True,
    quiet: _Quiet = False,
) -> None:
    """Which minds to imagine and to score with (the paper's Table IV, each evaluator's mean score beside it).

    Exit codes as of rex bench.
    """
    from reasoned_explorer.cli.ablate import ablate_minds
    from reasoned_explorer.cli.bench import BenchOptions
    from reasoned_explorer.cli.models import ModelOptions
    from reasoned_explorer.cli.parsing import parse_worlds

    _refuse_beside_resume(context)
    options = BenchOptions(
        split=split,
        worlds=parse_worlds(worlds or ()),
        bbox=bbox,
        per_cell=per_cell,
        split_seed=split_seed,
        seeds=seeds,
        minds=checker,
        vehicle=vehicle,
        latency=latency,
        workers=workers,
        ray=ray,
        out=out,
        resume=resume,
        traces=traces,
        quiet=quiet,
        models=ModelOptions(
            base_url=base_url,
            key_variable=key_variable,
            prices=prices,
            cache=cache,
            sample_anew=sample_anew,
            budget_usd=budget_usd,
            budget_minutes=budget_minutes,
        ),
    )
    ablate_minds(options, visionaries, evaluators)
