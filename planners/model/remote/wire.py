"""One request to a remote model in any of the three wire formats, through pydantic-ai's direct interface.

Converts messages, schema and images to pydantic-ai's types and its responses to answers. pydantic-ai is imported on the
first request.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from .. import pictures
from ..backend import Message
from .address import Address, Kind
from .errors import Extras, NothingError

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.messages import ModelMessage, ModelResponse, ModelResponseStreamEvent
    from pydantic_ai.models import Model, ModelRequestParameters
    from pydantic_ai.settings import ModelSettings

LONGEST_ANSWER = 16_384  # tokens, including a model's reasoning; the longest plan has 64 operations
_SEED = 0
_NAME = "answer"  # of the schema, and of the tool whose arguments are the answer


@dataclass(frozen=True)
class Question:
    """One request.

    Attributes:
        messages, schema: as in `ModelBackend.answer`; pictures within the limits of the server.
        extras: optional parameters.
        seconds: time limit of the connection.
        emit: called with the pieces of the answer, or with the whole if it is not streamed; None: not streamed.
    """

    messages: Sequence[Message]
    schema: dict[str, Any]
    extras: Extras
    seconds: float
    emit: Callable[[str], None] | None = None


@dataclass(frozen=True)
class Reply:
    """One response.

    Attributes:
        text: the model's answer.
        end: as `Answer.end`.
        input_tokens, output_tokens: as counted by the server, 0 if it did not.
        dollars: by published prices, None if unknown.
    """

    text: str
    end: Literal["done", "cut", "declined"]
    input_tokens: int
    output_tokens: int
    dollars: float | None


def import_libraries(kind: Kind) -> None:
    """Import the libraries of a wire format, which takes seconds the first time, and silence some of their warnings.

    Raises:
        ImportError: the packages are broken.
    """
    import importlib

    for module in ("pydantic_ai.direct", f"pydantic_ai.models.{kind}", f"pydantic_ai.providers.{kind}"):
        importlib.import_module(module)
    # Reasoning models without temperature and malformed responses are handled here, so users need no warning.
    for words in ("Sampling parameters", "Failed to extract usage", "Pydantic serializer", "Unexpected non-string"):
        warnings.filterwarnings("ignore", message=words)


def build(address: Address, client: httpx2.AsyncClient) -> Model[Any]:
    """pydantic-ai's model for an address."""
    # pydantic-ai guesses from the model's name whether a server accepts a schema; here the first request shows it.
    takes: Any = {"supports_json_schema_output": True, "supports_json_object_output": True}
    if address.kind == "anthropic":
        from pydantic_ai.models.anthropic import AnthropicModel
        from pydantic_ai.providers.anthropic import AnthropicProvider

        anthropic = AnthropicProvider(api_key=address.key, base_url=address.url, http_client=client)
        return AnthropicModel(address.model, provider=anthropic)
    if address.kind == "google":
        from pydantic_ai.models.google import GoogleModel
        from pydantic_ai.providers.google import GoogleProvider

        google = GoogleProvider(api_key=address.key, base_url=address.url, http_client=client)
        return GoogleModel(address.model, provider=google, profile=takes)
    from pydantic_ai.models.openai import OpenAIChatModel
    from pydantic_ai.providers.openai import OpenAIProvider
    from pydantic_ai.providers.openai_compatible import OpenAICompatibleProvider

    if not address.own:
        openai = OpenAIProvider(api_key=address.key, base_url=address.url, http_client=client)
        return OpenAIChatModel(address.model, provider=openai, profile=takes)
    takes["openai_chat_supports_max_completion_tokens"] = False  # compatible servers expect the older max_tokens
    compatible = OpenAICompatibleProvider(
        "openai-compatible", base_url=address.url, api_key=address.key, http_client=client
    )
    return OpenAIChatModel(address.model, provider=compatible, profile=takes)


async def ask(model: Model[Any], address: Address, question: Question) -> Reply:
    """Send one request.

    Raises:
        Exception: any error of pydantic-ai and its libraries; `errors.describe` turns it into a message.
    """
    from pydantic_ai.direct import model_request, model_request_stream

    options: dict[str, Any] = {
        "model_settings": _settings(question),
        "model_request_parameters": _parameters(address.kind, question.extras, question.schema),
        "instrument": False,
    }
    turns, emit = _turns(question.messages), question.emit
    if emit is None or not question.extras.stream:
        reply = _reply(await model_request(model, turns, **options), address)
        if emit is not None and reply.text:
            emit(reply.text)
        return reply
    async with model_request_stream(model, turns, **options) as stream:
        async for event in stream:
            if piece := _piece(event):
                emit(address.without_keys(piece))
        return _reply(stream.get(), address)


def _settings(question: Question) -> ModelSettings:
    extras = question.extras
    settings: ModelSettings = {"timeout": question.seconds, "max_retries": 0}
    if extras.temperature:
        settings["temperature"] = 0.0
    if extras.seed:
        settings["seed"] = _SEED
    if extras.length:
        settings["max_tokens"] = LONGEST_ANSWER
    return settings


def _parameters(kind: Kind, extras: Extras, schema: dict[str, Any]) -> ModelRequestParameters:
    """Parameters that constrain the answer to the schema.

    OpenAI's strict mode requires every property, Anthropic's has no recursion, and a query may contain queries.
    Therefore OpenAI and compatible servers get the schema in non-strict mode, Anthropic (and a compatible server that
    takes no schema) as the arguments of a tool that must be called, and Google in the subset that pydantic-ai supports.
    The schema is not added to the prompt.
    Sources: platform.openai.com/docs/guides/structured-outputs, platform.claude.com/docs structured outputs,
    ai.google.dev/gemini-api/docs/structured-output.
    """
    from pydantic_ai.models import ModelRequestParameters
    from pydantic_ai.output import OutputObjectDefinition
    from pydantic_ai.tools import ToolDefinition

    plain = loosened({key: value for key, value in schema.items() if key != "$schema"})
    if extras.form == "words":
        return ModelRequestParameters()
    if kind == "anthropic" or extras.form == "tool":
        tool = ToolDefinition(
            name=_NAME, parameters_json_schema=plain, description="Give the answer.", kind="output", strict=False
        )
        return ModelRequestParameters(output_mode="tool", output_tools=[tool], allow_text_output=False)
    return ModelRequestParameters(
        output_mode="native" if extras.form == "schema" else "prompted",
        output_object=OutputObjectDefinition(plain, name=_NAME, strict=False),
        prompted_output_template=False,
    )


def loosened(node: Any) -> Any:
    """The schema without alternatives beside `properties`. It allows more, and every server accepts it.

    Such alternatives state which fields go together. Anthropic refuses them at the root of a tool, and llama.cpp's
    grammars use the alternatives only and ignore the properties.
    """
    if isinstance(node, list):
        return [loosened(one) for one in node]
    if not isinstance(node, dict):
        return node
    dropped = {"anyOf", "oneOf", "allOf"} if "properties" in node else set()
    return {key: loosened(value) for key, value in node.items() if key not in dropped}


def _turns(messages: Sequence[Message]) -> list[ModelMessage]:
    from pydantic_ai import messages as parts

    turns: list[ModelMessage] = []
    for message in messages:
        if message.role == "assistant":
            turns.append(parts.ModelResponse([parts.TextPart(message.text or "(nothing)")]))
        elif message.role == "system":
            turns.append(parts.ModelRequest([parts.SystemPromptPart(message.text)]))
        elif not message.pictures:
            turns.append(parts.ModelRequest([parts.UserPromptPart(message.text)]))
        else:
            content: list[parts.UserContent] = []
            for part in pictures.parts(message):
                if isinstance(part, str):
                    content.append(part)
                else:
                    content.append(parts.BinaryContent(part, media_type=pictures.media_type(part)))
            turns.append(parts.ModelRequest([parts.UserPromptPart(content)]))
    return turns


def _piece(event: ModelResponseStreamEvent) -> str:
    """The text of the answer in an event, without a model's reasoning."""
    from pydantic_ai import messages as parts

    if isinstance(event, parts.PartStartEvent):
        return _part_text(event.part)
    if isinstance(event, parts.PartDeltaEvent):
        if isinstance(event.delta, parts.TextPartDelta):
            return event.delta.content_delta
        if isinstance(event.delta, parts.ToolCallPartDelta) and isinstance(event.delta.args_delta, str):
            return event.delta.args_delta
    return ""


def _part_text(part: object) -> str:
    from pydantic_ai import messages as parts

    if isinstance(part, parts.TextPart):
        return part.content
    if isinstance(part, parts.ToolCallPart) and part.args:
        return part.args if isinstance(part.args, str) else json.dumps(part.args, ensure_ascii=False)
    return ""


def _reply(response: ModelResponse, address: Address) -> Reply:
    from pydantic_ai import messages as parts

    if not response.parts and response.finish_reason is None:
        raise NothingError
    calls = [part for part in response.parts if isinstance(part, parts.ToolCallPart)]
    text = _part_text(calls[0]) if calls else "".join(_part_text(part) for part in response.parts)
    end: Literal["done", "cut", "declined"] = "done"
    if response.finish_reason == "length":
        end = "cut"
    elif response.finish_reason == "content_filter":
        end, text = "declined", _refusal(response, text)
    usage = response.usage
    return Reply(
        text=address.without_keys(text),
        end=end,
        input_tokens=_count(usage.input_tokens),
        output_tokens=_count(usage.output_tokens),
        dollars=None if address.own else _dollars(response),
    )


def _refusal(response: ModelResponse, text: str) -> str:
    details = response.provider_details or {}
    said = details.get("refusal") or details.get("block_reason_message") or text
    reason = details.get("block_reason") or details.get("finish_reason") or "content filter"
    return str(said or f"the provider stopped the answer ({reason})")


def _count(tokens: object) -> int:
    """A token count in the range that a receipt allows; 0 if it is not an integer."""
    return min(max(tokens, 0), 10**9) if isinstance(tokens, int) else 0


def _dollars(response: ModelResponse) -> float | None:
    try:
        price = float(response.cost().total_price)
    except (LookupError, ValueError, AssertionError):  # the model is not in the price list, or the usage is missing
        return None
    return price if 0 <= price <= 1e6 else None
