"""Models that are like those on the hub in everything but size: made here, of random weights, in under a second."""

from pathlib import Path
from typing import Any

_TEMPLATE = (
    "<|im_start|>{% for message in messages %}{{ message['role'] | capitalize }}: "
    "{% if message['content'] is string %}{{ message['content'] }}{% else %}{% for part in message['content'] %}"
    "{% if part['type'] == 'text' %}{{ part['text'] }}{% else %}<image>{% endif %}{% endfor %}{% endif %}"
    "<end_of_utterance>\n{% endfor %}{% if add_generation_prompt %}Assistant:{% endif %}"
)
#: Of a model that knows no system.
USERS_ONLY = "{% if messages[0]['role'] == 'system' %}{{ raise_exception('no system') }}{% endif %}" + _TEMPLATE
_MARKS = ["<fake_token_around_image>", "<image>", "<global-img>"]


_ENDS = {"pad_token": "<pad>", "bos_token": "<|im_start|>", "eos_token": "<end_of_utterance>"}
_WORDS = ("a", "the", "image", "shows", "features", "bench", "tree", "path", "on", "left", "right", "ahead", "describe")
_STRETCH = {"image_to_text_projection.latent_query": 0.05, "image_to_text_projection.dense.weight": 800.0}


def letters_tokenizer(template: str | None = _TEMPLATE) -> Any:
    """A tokenizer that knows every byte and the marks of SmolVLM."""
    from tokenizers import Tokenizer, decoders, models, pre_tokenizers
    from transformers import PreTrainedTokenizerFast

    letters = sorted(pre_tokenizers.ByteLevel.alphabet())
    inner = Tokenizer(models.BPE(vocab={letter: place for place, letter in enumerate(letters)}, merges=[]))
    inner.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    inner.decoder = decoders.ByteLevel()
    made = PreTrainedTokenizerFast(
        tokenizer_object=inner,
        additional_special_tokens=_MARKS,
        **_ENDS,
    )
    made.chat_template = template
    return made


def _text_settings(tokenizer: Any, positions: int = 4096) -> dict[str, Any]:
    return {
        "vocab_size": len(tokenizer),
        "hidden_size": 32,
        "intermediate_size": 64,
        "num_hidden_layers": 2,
        "num_attention_heads": 4,
        "num_key_value_heads": 2,
        "max_position_embeddings": positions,
        "pad_token_id": tokenizer.pad_token_id,
        "bos_token_id": tokenizer.bos_token_id,
        "eos_token_id": tokenizer.eos_token_id,
    }


def _saved(folder: Path, model: Any, *parts: Any) -> Path:
    import torch

    # Weights as small as a fresh model's say the same to everything; these tell one picture from another.
    with torch.no_grad():
        for name, parameter in model.named_parameters():
            if parameter.dim() > 1:
                parameter.mul_(_STRETCH.get(name, 8.0))
    for part in (model, *parts):
        part.save_pretrained(folder)
    return folder


def make_text_model(folder: Path, *, template: str | None = _TEMPLATE, positions: int = 4096) -> Path:
    """A Llama of two layers."""
    import torch
    from transformers import LlamaConfig, LlamaForCausalLM

    tokenizer = letters_tokenizer(template)
    torch.manual_seed(3)
    model = LlamaForCausalLM(LlamaConfig(**_text_settings(tokenizer, positions)))
    return _saved(folder, model, tokenizer)


def make_smolvlm(folder: Path, *, newer: bool) -> Path:
    """A SmolVLM: the first kind is an Idefics 3, the newer has a kind of its own, which also takes films."""
    import torch
    from transformers import (
        Idefics3Config,
        Idefics3ForConditionalGeneration,
        Idefics3ImageProcessorPil,
        Idefics3Processor,
        SmolVLMConfig,
        SmolVLMForConditionalGeneration,
        SmolVLMImageProcessorPil,
    )

    tokenizer = letters_tokenizer()
    images = (SmolVLMImageProcessorPil if newer else Idefics3ImageProcessorPil)(
        size={"longest_edge": 64}, max_image_size={"longest_edge": 32}, do_image_splitting=True
    )
    processor = Idefics3Processor(images, tokenizer, image_seq_len=4, chat_template=_TEMPLATE)
    config = (SmolVLMConfig if newer else Idefics3Config)(
        text_config={"model_type": "llama", **_text_settings(tokenizer)},
        vision_config={
            "hidden_size": 32,
            "intermediate_size": 64,
            "num_hidden_layers": 2,
            "num_attention_heads": 4,
            "image_size": 32,
            "patch_size": 8,
        },
        image_token_id=tokenizer.convert_tokens_to_ids("<image>"),
        scale_factor=2,
    )
    torch.manual_seed(3)
    model = (SmolVLMForConditionalGeneration if newer else Idefics3ForConditionalGeneration)(config)
    _saved(folder, model, processor)
    if newer:
        file = folder / "processor_config.json"
        file.write_text(file.read_text().replace("Idefics3Processor", "SmolVLMProcessor"))
    return folder


def make_kosmos_2(folder: Path) -> Path:
    """A Kosmos-2, with the places of its vocabulary that it is shown pictures at and that it marks places with."""
    import torch
    from transformers import (
        CLIPImageProcessorPil,
        Kosmos2Config,
        Kosmos2ForConditionalGeneration,
        Kosmos2Processor,
        XLMRobertaTokenizer,
    )

    vocabulary = [(mark, 0.0) for mark in ("<s>", "<pad>", "</s>", "<unk>")]
    vocabulary += [(f"<image_{place}>", -9.0) for place in range(64)]
    vocabulary += [(f"▁{word}", -2.0) for word in _WORDS]
    vocabulary += [(letter, -6.0) for letter in "▁abcdefghijklmnopqrstuvwxyz.,:"]
    tokenizer = XLMRobertaTokenizer(vocab=vocabulary)
    images = CLIPImageProcessorPil(size={"shortest_edge": 28}, crop_size={"height": 28, "width": 28})
    processor = Kosmos2Processor(images, tokenizer, num_patch_index_tokens=16)
    config = Kosmos2Config(
        text_config={
            "vocab_size": len(tokenizer),
            "embed_dim": 32,
            "layers": 2,
            "ffn_dim": 64,
            "attention_heads": 4,
            "max_position_embeddings": 512,
        },
        vision_config={
            "hidden_size": 32,
            "intermediate_size": 64,
            "num_hidden_layers": 2,
            "num_attention_heads": 4,
            "image_size": 28,
            "patch_size": 14,
        },
    )
    torch.manual_seed(3)
    model = Kosmos2ForConditionalGeneration(config)
    with torch.no_grad():
        # What stands for a picture is not written, and words rather than marks of places.
        model.get_input_embeddings().weight[4:68] = 0.0
        model.get_input_embeddings().weight[len(vocabulary) :] *= 0.3
    return _saved(folder, model, processor)
