"""What it saves to caption all views of a look in one batch, by a model on this machine.

Run it with ``python benchmarks/bench_local.py`` (needs the extra ``local``); nothing is asserted. The model has the
shape of SmolVLM-256M or of Kosmos-2, and random weights: the time is that of the real one, what it says is not. All
answers have the same number of tokens. ``--device cuda`` measures a graphics card. Seconds are the best of the
repeats: real ones, and of the processor. On a busy machine believe the latter, with ``OMP_NUM_THREADS=1``: threads
that wait for each other burn seconds, too.
"""

import argparse
import asyncio
import io
import time
from collections.abc import Callable, Coroutine, Sequence
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

from reasoned_explorer.calls.chat import ChatRequest
from reasoned_explorer.calls.local.coding import Coder, ConversationCoder, GroundingCoder
from reasoned_explorer.calls.local.generating import Generator
from reasoned_explorer.calls.local.model import LocalModel
from reasoned_explorer.perception.caption_prompt import CaptionPrompt, caption_prompt


def smolvlm(dtype: torch.dtype) -> tuple[Any, Coder]:
    """The shape of SmolVLM-256M-Instruct."""
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
    config = Idefics3Config(
        text_config={
            "model_type": "llama",
            "vocab_size": 49280,
            "hidden_size": 576,
            "intermediate_size": 1536,
            "num_hidden_layers": 30,
            "num_attention_heads": 9,
            "num_key_value_heads": 3,
            "max_position_embeddings": 8192,
        },
        vision_config={
            "hidden_size": 768,
            "intermediate_size": 3072,
            "num_hidden_layers": 12,
            "num_attention_heads": 12,
            "image_size": 512,
            "patch_size": 16,
        },
        image_token_id=tokenizer.convert_tokens_to_ids("<image>"),
        scale_factor=4,
    )
    return Idefics3ForConditionalGeneration(config).to(dtype), ConversationCoder(tokenizer, processor)


def kosmos_2(dtype: torch.dtype) -> tuple[Any, Coder]:
    """The shape of kosmos-2-patch14-224."""
    words = [(mark, 0.0) for mark in ("<s>", "<pad>", "</s>", "<unk>")]
    words += [(f"word{place}", -9.0) for place in range(64)]
    words += [(f"▁{word}", -2.0) for word in ("Describe", "this", "image", "in", "detail:")]
    words += [(f"more{place}", -9.0) for place in range(64000 - len(words))]
    processor = Kosmos2Processor(CLIPImageProcessorPil(), XLMRobertaTokenizer(vocab=words))
    return Kosmos2ForConditionalGeneration(Kosmos2Config()).to(dtype), GroundingCoder(processor)


def picture(number: int) -> bytes:
    pixels = np.random.default_rng(number).integers(0, 256, (224, 224, 3), dtype=np.uint8)
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()


def questions(prompt: CaptionPrompt, count: int, tokens: int) -> list[ChatRequest]:
    # The tokenizers made here know letters only: a quarter of the letters is as many tokens as the real ones make.
    system = prompt.system[: len(prompt.system) // 4]
    return [
        ChatRequest("caption", (0, 0, n), system, prompt.question, prompt.id, (picture(n),), max_tokens=tokens)
        for n in range(count)
    ]


async def together(model: LocalModel, requests: Sequence[ChatRequest]) -> None:
    answers = await asyncio.gather(*(model.ask(request) for request in requests))
    short = [answer for answer in answers if answer.tokens_out != requests[0].max_tokens]
    if short:
        raise SystemExit(f"not an answer of full length: {short[0]}")


async def apart(model: LocalModel, requests: Sequence[ChatRequest]) -> None:
    for request in requests:
        await together(model, [request])


def best_of(
    repeats: int,
    ask: Callable[[LocalModel, Sequence[ChatRequest]], Coroutine[Any, Any, None]],
    model: LocalModel,
    requests: Sequence[ChatRequest],
) -> tuple[float, float]:
    """Return the fewest real seconds and the fewest of the processor."""
    spent = []
    for _ in range(repeats):
        started_s, started_cpu_s = time.perf_counter(), time.process_time()
        asyncio.run(ask(model, requests))
        spent.append((time.perf_counter() - started_s, time.process_time() - started_cpu_s))
    return min(real for real, _ in spent), min(processor for _, processor in spent)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", choices=("smolvlm", "kosmos-2"), default="smolvlm")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--views", type=int, nargs="+", default=[3, 5, 8])
    parser.add_argument("--tokens", type=int, default=64)
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    transformers.logging.set_verbosity_error()
    dtype = torch.float32 if options.device == "cpu" else torch.bfloat16
    network, coder = {"smolvlm": smolvlm, "kosmos-2": kosmos_2}[options.model](dtype)
    network.generation_config.eos_token_id = None
    network.to(options.device).eval()
    model = LocalModel(
        Generator(network, coder, name="random"), name="random", fingerprint="", family=options.model, sees=True
    )
    weights = sum(parameter.numel() for parameter in network.parameters())
    print(
        f"{options.model}, {weights / 1e6:.0f} million weights, {dtype} on {options.device}, "
        f"{options.tokens} tokens an answer",
        flush=True,
    )
    prompt = caption_prompt(options.model)
    asyncio.run(together(model, questions(prompt, 1, options.tokens)))  # the first call builds what later ones use
    for count in options.views:
        requests = questions(prompt, count, options.tokens)
        (batch_s, batch_cpu_s), (single_s, single_cpu_s) = (
            best_of(options.repeats, ask, model, requests) for ask in (together, apart)
        )
        print(
            f"{count} views in one batch {batch_s:.2f} s, one by one {single_s:.2f} s: {single_s / batch_s:.2f} times; "
            f"of the processor {batch_cpu_s:.2f} s and {single_cpu_s:.2f} s: {single_cpu_s / batch_cpu_s:.2f} times",
            flush=True,
        )


if __name__ == "__main__":
    main()
