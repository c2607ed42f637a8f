// The question and its answer.

import { html } from "./parts.js";

export const ANSWERS = [
  ["yes", "Yes", "y"],
  ["partly", "Partly", "p"],
  ["no", "No", "n"],
];
const HOW_WELL = ["badly", "poorly", "fairly", "well", "perfectly"];

/** Whether there is enough of an answer to be kept. */
export const isWhole = (form) => Boolean(form.answer) && form.how_well !== null;

/** One of several buttons, of which one is chosen. */
function Choice({ name, value, label, hint, chosen, title, onChoose }) {
  return html`<label class="choice ${value} ${chosen ? "chosen" : ""}" title=${title}>
    <input type="radio" name=${name} value=${value} checked=${chosen} onChange=${() => onChoose(value)} />
    <span>${label}</span><kbd>${hint}</kbd>
  </label>`;
}

export function Form({ question, form, onChange, onSave, commentBox, longest, saving, status, mine }) {
  const lacks = !form.answer ? "Choose an answer." : form.how_well === null ? "Say how well." : "";
  return html`<form class="form" onSubmit=${(event) => { event.preventDefault(); onSave(); }}>
    <fieldset class="answers">
      <legend>${question}</legend>
      ${ANSWERS.map(([value, label, key]) => html`<${Choice} key=${value} name="answer" value=${value} label=${label} hint=${key} chosen=${form.answer === value}
        onChoose=${(answer) => onChange({ answer })} />`)}
    </fieldset>
    <fieldset class="grades">
      <legend>How well?</legend>
      ${HOW_WELL.map((words, at) => html`<${Choice} key=${at} name="how_well" value=${at + 1} label=${words} hint=${at + 1} chosen=${form.how_well === at + 1}
        title=${`${at + 1} of 5: ${words}`} onChoose=${(value) => onChange({ how_well: value })} />`)}
    </fieldset>
    <label class="comment">
      <span>Comment <span class="soft">(may be left out)</span> <kbd>c</kbd></span>
      <textarea rows="2" maxlength=${longest} ref=${commentBox} value=${form.comment} onInput=${(event) => onChange({ comment: event.target.value })}></textarea>
    </label>
    <div class="send">
      <button type="submit" class="main" disabled=${saving || !isWhole(form)}>${saving ? "Saving …" : mine ? "Save the change" : "Save and go on"} <kbd>Enter</kbd></button>
      <p class="status small ${status.tone}" role="status">${status.words || lacks}</p>
    </div>
  </form>`;
}
