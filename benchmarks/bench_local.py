"""What it saves to describe all views of a look in one batch, by a model on this machine.

Run it with ``python benchmarks/bench_local.py`` (needs the extra ``local``; or ``PYTHONPATH=src`` and torch,
transformers, numpy and Pillow); nothing is asserted and nothing is fetched. The model is a Kosmos-2, which the paper
looks with, or a SmolVLM-256M, small or with ``--full`` as large as the real one, and of random weights: the time is
that of the real one, what it says is not. All answers have the same number of tokens. It runs on a graphics card where
there is one.

Seconds are the best of the repeats: real ones, and of the processor. On a busy machine believe the latter, with
``OMP_NUM_THREADS=1``: threads that wait for each other burn seconds, too. Memory is what torch held of the card at most
beside the weights; without a card, what the process held at most, weights and all.
"""

import argparse
import asyncio
import io
import resource
import sys
import time
import tomllib
from collections.abc import Callable, Coroutine, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
import transformers
from PIL import Image
from tokenizers import Tokenizer, decoders, models, pre_tokenizers
from transformers import (
    CLIPImageProcessorPil,
    Idefics3Config,
    Idefics3ForConditionalGeneration,
    Idefics3ImageProcessorPil,
    Idefics3Processor,
    Kosmos2Config,
    Kosmos2ForConditionalGeneration,
    Kosmos2Processor,
    PreTrainedTokenizerFast,
    XLMRobertaTokenizer,
)

import reasoned_explorer
from reasoned_explorer.calls.chat import ChatRequest
from reasoned_explorer.calls.local.coding import Coder, ConversationCoder, GroundingCoder
from reasoned_explorer.calls.local.generating import Generator
from reasoned_explorer.calls.local.model import LocalModel

#: What a model's family is asked, read here without what checks it, so that a machine without pydantic will do.
_PROMPTS = {"kosmos-2": "caption-kosmos-2", "smolvlm": "caption"}
_SMALL = {"hidden_size": 64, "intermediate_size": 128, "num_hidden_layers": 2, "num_attention_heads": 4}


def smolvlm(*, full: bool) -> tuple[Callable[[], Any], Coder]:
    """Return what makes a network of the shape of SmolVLM-256M-Instruct, and its coder."""
    letters = sorted(pre_tokenizers.ByteLevel.alphabet())
    inner = Tokenizer(models.BPE(vocab={letter: place for place, letter in enumerate(letters)}, merges=[]))
    # A real tokenizer makes a token of about four letters; so does this one, whatever they are.
    inner.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    inner.decoder = decoders.ByteLevel()
    ends = {"pad_token": "<pad>", "eos_token": "<end>"}
    tokenizer = PreTrainedTokenizerFast(
        tokenizer_object=inner,
        additional_special_tokens=["<fake_token_around_image>", "<image>", "<global-img>"],
        **ends,
    )
    size = {"size": {"longest_edge": 2048}, "max_image_size": {"longest_edge": 512}}
    processor = Idefics3Processor(Idefics3ImageProcessorPil(**size), tokenizer, image_seq_len=64)
    processor.chat_template = (
        "{% for m in messages %}{% for p in m.content %}{{ p.text or '<image>' }}{% endfor %}{% endfor %}"
    )
    text = {"hidden_size": 576, "intermediate_size": 1536, "num_hidden_layers": 30, "num_attention_heads": 9}
    vision = {"hidden_size": 768, "intermediate_size": 3072, "num_hidden_layers": 12, "num_attention_heads": 12}
    config = Idefics3Config(
        text_config={
            "model_type": "llama",
            "vocab_size": 49280,
            "num_key_value_heads": 3 if full else 2,
            "max_position_embeddings": 8192,
            **(text if full else _SMALL),
        },
        vision_config={"image_size": 512, "patch_size": 16, **(vision if full else _SMALL)},
        image_token_id=tokenizer.convert_tokens_to_ids("<image>"),
        scale_factor=4,
    )
    return lambda: Idefics3ForConditionalGeneration(config), ConversationCoder(tokenizer, processor)


def kosmos_2(*, full: bool) -> tuple[Callable[[], Any], Coder]:
    """Return what makes a network of the shape of kosmos-2-patch14-224, and its coder."""
    words = [(mark, 0.0) for mark in ("<s>", "<pad>", "</s>", "<unk>")]
    words += [(f"word{place}", -9.0) for place in range(64)]
    words += [(f"▁{word}", -2.0) for word in ("Describe", "this", "image", "in", "detail:")]
    words += [(f"more{place}", -9.0) for place in range(64000 - len(words))]
    processor = Kosmos2Processor(CLIPImageProcessorPil(), XLMRobertaTokenizer(vocab=words))
    small = {"embed_dim": 64, "layers": 2, "ffn_dim": 128, "attention_heads": 4}
    # What the configuration says by itself is the real one's shape.
    config = Kosmos2Config() if full else Kosmos2Config(text_config=small, vision_config=_SMALL)
    return lambda: Kosmos2ForConditionalGeneration(config), GroundingCoder(processor)


def picture(number: int) -> bytes:
    pixels = np.random.default_rng(number).integers(0, 256, (224, 224, 3), dtype=np.uint8)
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()


def questions(family: str, count: int, tokens: int) -> list[ChatRequest]:
    file = Path(reasoned_explorer.__file__).parent / "perception" / "prompts" / f"{_PROMPTS[family]}.toml"
    prompt = tomllib.loads(file.read_text(encoding="utf-8"))
    # The tokenizers made here know letters only: a quarter of the letters is as many tokens as the real ones make.
    system, question = prompt["system"].strip(), prompt["question"].strip()
    return [
        ChatRequest("caption", (0, 0, n), system[: len(system) // 4], question, "", (picture(n),), max_tokens=tokens)
        for n in range(count)
    ]


def made(family: str, device: str, dtype: torch.dtype, *, full: bool) -> tuple[LocalModel, int]:
    """Return a model of random weights, and how many of them it has."""
    make, coder = {"smolvlm": smolvlm, "kosmos-2": kosmos_2}[family](full=full)
    usual = torch.get_default_dtype()
    torch.manual_seed(0)
    torch.set_default_dtype(dtype)
    try:
        with torch.device(device):
            network = make()
    finally:
        torch.set_default_dtype(usual)
    # Nothing ends an answer before its length.
    network.generation_config.eos_token_id = None
    network.generation_config.suppress_tokens = [coder.tokenizer.eos_token_id]
    network.to(device).eval()
    generator = Generator(network, coder, name="random")
    model = LocalModel(generator, name="random", fingerprint="", family=family, sees=True)
    return model, sum(parameter.numel() for parameter in network.parameters())


async def together(model: LocalModel, requests: Sequence[ChatRequest]) -> None:
    answers = await asyncio.gather(*(model.ask(request) for request in requests))
    short = [answer for answer in answers if answer.tokens_out != requests[0].max_tokens]
    if short:
        raise SystemExit(f"not an answer of full length: {short[0]}")


async def apart(model: LocalModel, requests: Sequence[ChatRequest]) -> None:
    for request in requests:
        await together(model, [request])


@dataclass(frozen=True, slots=True)
class Spent:
    """The least of some repeats: real seconds and the processor's; the most MiB, and the most batches that one took."""

    real_s: float
    processor_s: float
    memory_mib: float
    batches: int


def spent_on(
    ask: Callable[[LocalModel, Sequence[ChatRequest]], Coroutine[Any, Any, None]],
    model: LocalModel,
    requests: Sequence[ChatRequest],
    repeats: int,
) -> Spent:
    """Return what asking in one way takes."""
    spent = []
    for _ in range(repeats):
        before, held_mib = len(model.batches), memory_mib(model.device, anew=True)
        started_s, started_cpu_s = time.perf_counter(), time.process_time()
        asyncio.run(ask(model, requests))
        real_s, processor_s = time.perf_counter() - started_s, time.process_time() - started_cpu_s
        spent.append((real_s, processor_s, memory_mib(model.device) - held_mib, len(model.batches) - before))
    real, processor, memory, batches = zip(*spent, strict=True)
    return Spent(min(real), min(processor), max(memory), max(batches))


def memory_mib(device: str, *, anew: bool = False) -> float:
    """Return the most memory that was held so far: of the card, counted anew from now on if so wanted; or of all."""
    if device.startswith("cuda"):
        if anew:
            torch.cuda.reset_peak_memory_stats(device)
        held: int = torch.cuda.max_memory_allocated(device)  # right after a reset, what is held now
        return held / 2**20
    unit = 2**20 if sys.platform == "darwin" else 2**10
    return 0.0 if anew else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", choices=("kosmos-2", "smolvlm"), default="kosmos-2")
    parser.add_argument("--full", action="store_true", help="as large as the real one")
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    parser.add_argument("--views", type=int, nargs="+", default=[3, 5, 8])
    parser.add_argument("--tokens", type=int, default=64, help="of each answer")
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    transformers.logging.set_verbosity_error()
    dtype = torch.float32 if options.device == "cpu" else torch.bfloat16
    started_s = time.perf_counter()
    model, weights = made(options.model, options.device, dtype, full=options.full)
    where = torch.cuda.get_device_name(options.device) if options.device.startswith("cuda") else "the processor"
    print(
        f"{options.model}, {weights / 1e6:.0f} million random weights ({'full size' if options.full else 'small'}), "
        f"{dtype} on {where}, {options.tokens} tokens an answer; torch {torch.__version__}, transformers "
        f"{transformers.__version__}; made in {time.perf_counter() - started_s:.0f} s",
        flush=True,
    )
    if options.device.startswith("cuda"):
        print(f"the weights take {torch.cuda.memory_allocated(options.device) / 2**20:.0f} MiB of the card", flush=True)
    for count in options.views:
        requests = questions(options.model, count, options.tokens)
        asyncio.run(together(model, requests))  # the first call of a size builds what later ones use
        # One by one first: the most that a process ever held does not come down again.
        single, batch = (spent_on(ask, model, requests, options.repeats) for ask in (apart, together))
        print(
            f"{count} views: one by one {single.real_s:.2f} s ({single.batches} batches, {single.memory_mib:.0f} MiB), "
            f"together {batch.real_s:.2f} s ({batch.batches} batch{'es' * (batch.batches > 1)}, {batch.memory_mib:.0f} "
            f"MiB): {single.real_s / batch.real_s:.2f} times as fast; of the processor {single.processor_s:.2f} s and "
            f"{batch.processor_s:.2f} s: {single.processor_s / batch.processor_s:.2f} times",
            flush=True,
        )


if __name__ == "__main__":
    main()
