"""Detect words in an instruction that justify removing things: removing, exchanging, keeping only, hiding, and "all".

The words cover the languages that users mostly speak to models in. With a superfluous word, a mistaken plan
reaches the editor's own checks, and the user can undo it; with a missing word, the user must rephrase.
"""

from __future__ import annotations

import re
from functools import cache
from typing import Literal

Ground = Literal["removing", "exchanging", "keeping", "hiding", "all"]

# Prefixes of words; "=" marks a whole word, "_" a space. Words of scripts without spaces match anywhere.
_WORDS: dict[Ground, str] = {
    "removing": """
        delet remov eras eliminat discard dispos =rid trash =bin =binned =scrap scrapp =junk dump ditch toss chuck throw
        =threw =lose =losing =kill nuke =nuking zap purg expung banish destroy obliterat vapori =wip wipe wiping clear
        empt =strip stripp clean tidy declutter drop tak =took yank =rip oust evict =axe =cull =cut gone vanish
        disappear without unwanted minimal simplif reduc =thin thinn sell =sold donat fewer =less minus subtract
        exclud except annihilat abolish get_out has_to_go have_to_go must_go should_go can_go needs_to_go need_to_go
        got_to_go gotta_go go_away put_away pack_away free_up no_more not_want don't_want dont_want not_need don't_need
        dont_need don't_like dont_like not_like make_room make_space make_way sick_of tired_of had_enough kick
        lösch loesch entfern beseit wegnehm =weg =raus hinaus =ohne leere räum aufräum wegwerf =wirf verschwind schmeiß
        supprim enlev retir effac jett =jeter =jetez débarrass =vide =vider =videz =ôte =ôter =sans dégag
        elimin borra borre =quita =quitar =quitad saca =tira tirar deshaz deshac =sin vacía vacia desaparec =limpia
        =limpiar cancell rimuov rimoss togli =butta buttare svuot =senza sgomber apaga =elimina exclua =joga =jogue =sem
        esvazi verwijder weghal =gooi =wis =zonder opruim ta_bort radera släng fjern slett =slet =utan =uden =uten
        usuń usun wyrzu skasuj =bez zabierz odstra smaž smaz vyhoď vyhod удал убер убра сотр стер выкин выброс очист
        =без видал прибер =sil =silin kaldır kaldir çıkar
        删 刪 去掉 移除 清除 扔 拿走 清空 消除 消して 削除 取り除 どけて 片付 捨て なくし 삭제 제거 없애 치워 지워 버려
        हटा निकाल احذف أزل حذف إزالة מחק הסר
    """,
    "exchanging": """
        replac swap switch exchang substitut =trade =traded trading chang convert transform becom instead rather upgrad
        =into update
        ersetz tausch austausch wechsel =statt stattdessen remplac échang plutôt reemplaz cambi sustitu sostitu scambi
        troca troque substitu vervang =ruil =byt =bytt erstatt zamie zastąp wymień замен помен değiştir degistir
        换 換 代替 改成 置き換 交換 変え 取り替 교체 바꿔 बदल استبدل החלף
    """,
    "keeping": """
        isolat =only =just =keep =keeping =leave =leaving except exclud =but =solo nothing_but =alone single_out
        everything_else all_else =rest others focus
        =nur behalt isolier =außer =ausser =bloß allein =sauf =seul =seule =garde =garder =gardez isol uniquement =sólo
        deja =menos excepto aísl aisl =tranne lasci mantien apenas somente exceto deix alleen behalve houd =bara endast
        behåll =kun =bare behold tylko zostaw oprócz =jen nech kromě только остав кроме sadece yalnız
        只 仅 僅 保留 除了 だけ 残し 以外 만 빼고 남겨 सिर्फ केवल فقط רק
    """,
    "hiding": """
        hide hiding hidden invisib transparen opac see-through see_through fade fading ghost vanish disappear conceal
        unsichtbar versteck ausblend durchsichtig verschwind cache cacher masqu ocult escond invisível nascond verberg
        onzichtba dölj osynlig skjul ukryj skryj скр спря невидим прозрач gizle saydam görünmez
        隐 隱 透明 藏 隠 숨 투명 छिपा أخف הסתר
    """,
    "all": """
        =all every =whole =entire =both =each =any anything total complet =rest others =other =room =scene clear empt
        tidy declutter =strip clean minimal except =but =only =just nothing else remaining
        =alle =alles =allen ganz sämtlich =beide übrig =zimmer =raum =tout =tous =toute =toutes chaque =entier =pièce
        =reste =todo =todos =toda =todas =cada =entero =entera =ambos =resto habitación =cuarto =tutto =tutti =tutte
        =ogni =intero =stanza =tudo =sala =quarto inteir elke =hele =kamer =allt =alla varje =hela =alt =hver wszystk
        każd =cały =pokój všechn =celý =все =всё всех кажд =весь =всю комнат остал hepsi =tüm bütün =oda
        全 所有 都 整 每 房间 すべて みんな 部屋 모두 모든 전부 방 सब सभी पूरा كل جميع הכל כל
    """,
}
_UNSPACED = re.compile(r"[\u0e00-\u0eff\u1000-\u109f\u3040-\u30ff\u3400-\u9fff\uac00-\ud7af]")


def mentions(ground: Ground, *texts: str | None) -> bool:
    """Whether any of the texts contains a word of this kind."""
    return any(_pattern(ground).search(" ".join(text.casefold().split()).replace("’", "'")) for text in texts if text)


@cache
def _pattern(ground: Ground) -> re.Pattern[str]:
    every = [w.casefold().replace("_", " ") for w in _WORDS[ground].split()]
    anywhere = [re.escape(w) for w in every if _UNSPACED.search(w)]
    begins = [re.escape(w) for w in every if not _UNSPACED.search(w) and w[0] != "="]
    whole = [re.escape(w[1:]) + r"(?![^\W_])" for w in every if w[0] == "="]
    return re.compile("|".join([*anywhere, rf"(?<![^\W_])(?:{'|'.join([*begins, *whole])})"]))
